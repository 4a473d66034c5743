#pragma once
/// Devices to begin with in a town of which nobody said where devices are. Private to dcem::io.
#include <nlohmann/json.hpp>
#include <vector>

#include "dcem/io/src/import/import_draft.hpp"

namespace dcem::io {

/// At most `count` points outside of all parts, 1.5 m above the ground, on circles around a point.
nlohmann::ordered_json open_points_json(const ImportDraft& draft, const std::vector<TownPart>& parts,
                                        const Vec2& around_m, std::size_t count);

}  // namespace dcem::io
