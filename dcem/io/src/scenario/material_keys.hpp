#pragma once
/// The electromagnetic keys of a material, from an MTL file or from a scenario, and the material they make.
/// Private to dcem::io.
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "dcem/em/surface/material.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

/// One key with its value and where it stands.
struct MaterialKey {
  std::variant<double, std::string, std::vector<MaterialLayer>> value;
  std::string place;     ///< FILE or FILE:LINE
  std::string spelling;  ///< as the user wrote it: "em_reflection", "materials.wall.reflection"

  /// Throws InputError: `place: spelling: what`.
  [[noreturn]] void fail(const std::string& what) const;
};

/// The keys of one material, by their names without `em_`.
struct MaterialKeys {
  std::string place;  ///< of the material itself
  std::map<std::string, MaterialKey> keys;
};

/// The canonical name of the material of ITU-R P.2040 that a key names. Throws InputError with the nearest one.
std::string itu_name(const MaterialKey& key);

/// A key of a material, `em_` left out, with what its text says. `place` and `spelling` are for messages. Throws
/// InputError on an unknown key, and on what should be a number in the key's range and is none.
MaterialKey key_from_text(const std::string& name, const std::string& text, std::string place, std::string spelling);

/// The keys of a `newmtl` block. Throws InputError on an unknown key, on what should be a number and is none, and on
/// the model `multilayer`, whose layers only a scenario can hold.
MaterialKeys keys_from_mtl(const MtlMaterial& mtl);

/// The keys of the MTL file, overridden or completed by those of the scenario. Where the scenario names another model
/// than the file does, the file's keys do not count: they belong to a model that is not wanted.
MaterialKeys merged(const MaterialKeys& from_mtl, const MaterialKeys& from_scenario);

/// Whether two definitions say the same, wherever they stand.
bool same_definition(const MaterialKeys& a, const MaterialKeys& b);

/// The material that keys and name define: the keys first, then an `itu_*` name; absent where neither says anything.
/// Throws InputError on values out of range, on keys that do not go with the model.
std::optional<Material> make_material(const std::string& name, const MaterialKeys& keys);

}  // namespace dcem::io
