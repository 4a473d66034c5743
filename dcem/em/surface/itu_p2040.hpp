#pragma once
/// Electrical properties of building materials and ground, Recommendation ITU-R P.2040, Table 3.
///   ε' = a·f^b,  σ = c·f^d in S/m, f in GHz.
/// Two revisions are kept because their numbers differ: 3 (08/2023) and 4 (09/2025). Revision 3 as tabulated in
/// sionna-rt 2.0.1 and revision 4 as tabulated in DiffeRT; see docs/physics.md. Frequency intervals are closed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/em/surface/itu_settings.hpp"
#include "dcem/em/surface/range_check.hpp"

namespace dcem {

/// Properties of one material at one frequency.
struct ItuProperties {
  double relative_permittivity = 1.0;
  double conductivity_s_per_m = 0.0;
  bool extrapolated = false;  ///< the frequency lies outside every interval of the table
};

/// One row of the table: a closed interval of frequency and the four numbers of the power laws.
struct ItuRow {
  int revision;
  std::string_view name;
  double min_frequency_ghz, max_frequency_ghz;
  double a, b, c, d;
};

inline constexpr std::array<ItuRow, 39> itu_rows{{
    {3, "concrete", 1, 100, 5.24, 0, 0.0462, 0.7822},
    {3, "brick", 1, 40, 3.91, 0, 0.0238, 0.16},
    {3, "plasterboard", 1, 100, 2.73, 0, 0.0085, 0.9395},
    {3, "wood", 0.001, 100, 1.99, 0, 0.0047, 1.0718},
    {3, "glass", 0.1, 100, 6.31, 0, 0.0036, 1.3394},
    {3, "glass", 220, 450, 5.79, 0, 0.0004, 1.658},
    {3, "ceiling_board", 1, 100, 1.48, 0, 0.0011, 1.0750},
    {3, "ceiling_board", 220, 450, 1.52, 0, 0.0029, 1.029},
    {3, "chipboard", 1, 100, 2.58, 0, 0.0217, 0.7800},
    {3, "plywood", 1, 40, 2.71, 0, 0.33, 0},
    {3, "marble", 1, 60, 7.074, 0, 0.0055, 0.9262},
    {3, "floorboard", 50, 100, 3.66, 0, 0.0044, 1.3515},
    {3, "metal", 1, 100, 1, 0, 1e7, 0},
    {3, "very_dry_ground", 1, 10, 3, 0, 0.00015, 2.52},
    {3, "medium_dry_ground", 1, 10, 15, -0.1, 0.035, 1.63},
    {3, "wet_ground", 1, 10, 30, -0.4, 0.15, 1.30},
    {4, "concrete", 1, 100, 5.24, 0, 0.0462, 0.7822},
    {4, "concrete", 110, 330, 5.17, 0, 0.0145, 1.09},
    {4, "brick", 1, 40, 3.91, 0, 0.0238, 0.16},
    {4, "brick", 100, 400, 3.95, 0, 0.0022, 1.33},
    {4, "plasterboard", 1, 100, 2.94, 0, 0.0116, 0.7076},
    {4, "plasterboard", 100, 400, 2.73, 0, 0.0084, 0.94},
    {4, "wood", 0.001, 100, 1.99, 0, 0.0047, 1.0718},
    {4, "wood", 100, 400, 1.63, 0, 0.0076, 1.002},
    {4, "glass", 0.1, 100, 6.27, 0, 0.0043, 1.1925},
    {4, "glass", 100, 400, 6.70, 0, 0.0042, 1.15},
    {4, "clear_acrylic", 1, 40, 2.57, 0, 0.0049, 1.0601},
    {4, "ceiling_board", 1, 100, 1.48, 0, 0.0011, 1.1278},
    {4, "ceiling_board", 100, 400, 1.58, 0, 0.0014, 1.07},
    {4, "chipboard", 1, 100, 2.58, 0, 0.0217, 0.7800},
    {4, "plywood", 1, 40, 2.71, 0, 0.33, 0},
    {4, "plywood", 110, 330, 1.94, 0, 0.0067, 0.9982},
    {4, "marble", 1, 60, 7.074, 0, 0.0055, 0.9262},
    {4, "marble", 110, 330, 7.94, 0, 0.0001, 1.7330},
    {4, "floorboard", 50, 100, 3.66, 0, 0.0044, 1.3515},
    {4, "vinyl_tile", 1, 40, 3.62, 0, 0.0051, 0.8422},
    {4, "carpet_tile", 1, 40, 2.08, 0, 0.0009, 0.8200},
    {4, "asphalt_concrete", 1, 40, 4.83, 0, 0.0108, 1.3969},
    {4, "metal", 1, 100, 1, 0, 1e7, 0},
}};

namespace detail {

/// How far a frequency lies outside a row's interval, as the logarithm of a ratio; 0 inside and on its ends. A ratio,
/// because the rows are power laws of the frequency.
inline double octaves_outside(const ItuRow& row, double frequency_ghz) {
  if (frequency_ghz < row.min_frequency_ghz) return std::log2(row.min_frequency_ghz / frequency_ghz);
  if (frequency_ghz > row.max_frequency_ghz) return std::log2(frequency_ghz / row.max_frequency_ghz);
  return 0.0;
}

/// The row of `name` whose interval is nearest; of two that hold the frequency, the lower one. Null: no such name.
inline const ItuRow* nearest_itu_row(std::string_view name, double frequency_ghz, int revision) {
  const ItuRow* nearest = nullptr;
  for (const ItuRow& row : itu_rows) {
    if (row.revision != revision || row.name != name) continue;
    if (!nearest || octaves_outside(row, frequency_ghz) < octaves_outside(*nearest, frequency_ghz)) nearest = &row;
  }
  return nearest;
}

inline std::string itu_intervals_text(std::string_view name, int revision) {
  std::string text, separator;
  for (const ItuRow& row : itu_rows) {
    if (row.revision != revision || row.name != name) continue;
    text += separator + short_number(row.min_frequency_ghz) + " to " + short_number(row.max_frequency_ghz);
    separator = " and ";
  }
  return text + " GHz";
}

[[noreturn]] inline void throw_unknown_itu_material(std::string_view name, int revision) {
  std::string message =
      "material '" + std::string(name) + "' is not in ITU-R P.2040 revision " + std::to_string(revision);
  const auto other =
      std::find_if(itu_rows.begin(), itu_rows.end(), [&](const ItuRow& row) { return row.name == name; });
  if (other != itu_rows.end()) message += " (it is in revision " + std::to_string(other->revision) + ")";
  throw std::invalid_argument(message);
}

}  // namespace detail

/// Names of the table's materials, sorted, e.g. "concrete". `revision` 3 or 4; any other has none.
inline std::vector<std::string> itu_material_names(int revision) {
  std::vector<std::string> names;
  for (const ItuRow& row : itu_rows)
    if (row.revision == revision) names.emplace_back(row.name);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// The table's spelling of a material ("medium-dry-ground" → "medium_dry_ground"), known in at least one revision;
/// nothing if there is no such material.
inline std::optional<std::string> canonical_itu_name(std::string_view name) {
  std::string canonical(name);
  std::replace(canonical.begin(), canonical.end(), '-', '_');
  const bool known =
      std::any_of(itu_rows.begin(), itu_rows.end(), [&](const ItuRow& row) { return row.name == canonical; });
  return known ? std::optional(canonical) : std::nullopt;
}

/// The ITU material that a scene's material name stands for: "itu_concrete", "itu-concrete", "itu_medium_dry_ground" →
/// the canonical name without the prefix; nothing for every other name.
inline std::optional<std::string> itu_name_from_material_name(std::string_view material_name) {
  if (!material_name.starts_with("itu_") && !material_name.starts_with("itu-")) return std::nullopt;
  return canonical_itu_name(material_name.substr(4));
}

/// Relative permittivity and conductivity of `name` (canonical) at `frequency_hz`.
/// Outside all intervals of the material: with `allow_extrapolation` the formula of the nearest interval (nearest by
/// the ratio of frequencies), with `extrapolated` set; else std::invalid_argument that names material, frequency and
/// intervals. Unknown names, revisions other than 3 and 4 and frequencies ≤ 0 throw std::invalid_argument.
inline ItuProperties itu_properties(std::string_view name, double frequency_hz, int revision,
                                    bool allow_extrapolation) {
  if (revision != 3 && revision != 4)
    throw std::invalid_argument("ITU-R P.2040 revision " + std::to_string(revision) +
                                " is not tabulated; expected 3 or 4");
  if (!(frequency_hz > 0.0) || !std::isfinite(frequency_hz))
    throw std::invalid_argument("frequency must be positive and finite");
  const double frequency_ghz = frequency_hz / 1e9;
  const ItuRow* row = detail::nearest_itu_row(name, frequency_ghz, revision);
  if (!row) detail::throw_unknown_itu_material(name, revision);
  const bool outside = detail::octaves_outside(*row, frequency_ghz) > 0.0;
  if (outside && !allow_extrapolation) {
    throw std::invalid_argument("material '" + std::string(name) + "' at " + detail::short_number(frequency_ghz) +
                                " GHz is outside the range of ITU-R P.2040 revision " + std::to_string(revision) +
                                ": " + detail::itu_intervals_text(name, revision));
  }
  return {row->a * std::pow(frequency_ghz, row->b), row->c * std::pow(frequency_ghz, row->d), outside};
}

inline ItuProperties itu_properties(std::string_view name, double frequency_hz, const ItuSettings& settings = {}) {
  return itu_properties(name, frequency_hz, settings.revision, settings.allow_extrapolation);
}

}  // namespace dcem
