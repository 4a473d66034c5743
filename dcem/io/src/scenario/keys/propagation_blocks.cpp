#include "dcem/em/medium/atmosphere.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::io::keys {

namespace {

constexpr double highest_order = 10, highest_diffraction_order = 3;
constexpr double most_rays = 1e8;

const BlockRule& diffraction_block() {
  static const DiffractionSettings standards{};
  static const BlockRule rule{
      "propagation.diffraction",
      "Which edges diffract, and how.",
      {{"lossy_wedge",
        {word<LossyWedge>()},
        standard(standards.lossy_wedge),
        "How lossy faces enter the coefficient.",
        R"("holm_reciprocal")"},
       {"region",
        {word<DiffractionRegion>()},
        standard(standards.region),
        "everywhere: the total field is continuous; shadow: only where the wedge hides the two sides from each other.",
        R"("everywhere")"},
       {"free_edges",
        {boolean()},
        standard(standards.free_edges),
        "Rims of open sheets diffract as half planes.",
        "false"},
       {"min_exterior_angle_deg",
        {number({180.0, 360.0, true}, "deg")},
        standard(standards.min_exterior_angle_deg),
        "Flatter edges do not diffract.",
        "190"}}};
  return rule;
}

const BlockRule& diffuse_block() {
  static const DiffuseSettings standards{};
  static const BlockRule rule{
      "propagation.diffuse",
      "Power that rough surfaces scatter; the block switches it on.",
      {{"enabled", {boolean()}, standard(true), "Whether it is summed.", "true"},
       {"tile_max_m",
        {number({1e-3, 1e6}, "m"), null()},
        Absence{Absence::Kind::value, "null"},
        "No tile has a longer edge; null: as the sum needs.",
        "5"},
       {"tolerance_db",
        {number({1e-4, 10.0}, "dB")},
        standard(standards.tolerance_db),
        "To which the sum has converged.",
        "0.1"},
       {"phases",
        {word<DiffusePhases>()},
        standard(standards.phases),
        "Of tiles: powers, or phases from the seed.",
        R"("incoherent")"},
       {"list_paths",
        {boolean()},
        standard(standards.list_paths),
        "Whether each point of a tile is listed as a path S.",
        "false"},
       {"tile_budget",
        {whole_number(1, 1e8)},
        standard(standards.tile_budget),
        "Tiles, of seven points each, evaluated for one link; where they do not suffice the result says so.",
        "20000"}}};
  return rule;
}

const BlockRule& path_loss_block() {
  static const CloseIn standards{};
  static const BlockRule rule{
      "propagation.path_loss",
      "A real factor beside the spreading in free space, on the total length.",
      {{"model",
        {word({"free_space", "close_in"})},
        required(),
        "free_space: none; close_in: exponent and loss per metre.",
        R"("close_in")"},
       {"exponent", {number({0.0, 10.0, true})}, standard(standards.exponent), "Goes with close_in only.", "2.1"},
       {"attenuation_db_per_m",
        {number({0.0, 1000.0}, "dB/m")},
        standard(standards.attenuation_db_per_m),
        "Goes with close_in only.",
        "0.01"}}};
  return rule;
}

const BlockRule& atmosphere_block() {
  static const Atmosphere standards{};
  static const BlockRule rule{
      "propagation.atmosphere",
      "Losses of gases (ITU-R P.676) and rain (P.838); the block switches them on.",
      {{"gas", {boolean()}, standard(standards.gas), "Whether oxygen and water vapour attenuate.", "true"},
       {"temperature_k", {number({150.0, 350.0}, "K")}, standard(standards.temperature_k), "Of the air.", "288.15"},
       {"dry_pressure_hpa",
        {number({0.0, 1200.0}, "hPa")},
        standard(standards.dry_pressure_hpa),
        "Of the air without its vapour.",
        "1013.25"},
       {"water_vapour_g_per_m3",
        {number({0.0, 100.0}, "g/m3")},
        standard(standards.water_vapour_g_per_m3),
        "Density of the vapour.",
        "7.5"},
       {"rain_mm_per_h",
        {number({0.0, max_rain_mm_per_h}, "mm/h")},
        standard(standards.rain_mm_per_h),
        "Rain rate.",
        "12.5"}}};
  return rule;
}

std::vector<KeyRule> keys_of_orders(const PropagationSettings& standards) {
  return {
      {"line_of_sight", {boolean()}, standard(standards.line_of_sight), "Whether the direct path is reported.", "true"},
      {"max_reflections",
       {whole_number(0, highest_order)},
       standard(standards.max_reflections),
       "Reflections of a path.",
       "2"},
      {"max_transmissions",
       {whole_number(0, highest_order)},
       standard(standards.max_transmissions),
       "Sheets that a path may cross.",
       "2"},
      {"max_diffractions",
       {whole_number(0, highest_diffraction_order)},
       standard(standards.max_diffractions),
       "Diffractions of a path.",
       "1"},
      {"max_interactions",
       {whole_number(0, highest_order + highest_diffraction_order)},
       told("max_reflections + max_diffractions"),
       "Reflections and diffractions together.",
       "2"},
  };
}

std::vector<KeyRule> keys_of_discovery(const PropagationSettings& standards) {
  return {
      {"discovery",
       {word<Discovery>()},
       told("exact as far as it is offered; beyond, rays look for longer paths"),
       "exact: every path within the orders, or an error; sampled: rays alone.",
       R"("exact")"},
      {"rays",
       {whole_number(1, most_rays)},
       standard(standards.rays),
       "Rays for a receiver in a frame without history. Where discovery is exact it has no effect, which is warned of.",
       "2000"},
      {"rays_steady",
       {whole_number(1, most_rays)},
       told("a tenth of rays"),
       "The same in a later frame with cache seed.",
       "200"},
      {"seed",
       {whole_number(0, 9e18)},
       standard(standards.seed),
       "Turns the sphere of rays. Where discovery is exact, and the phases of diffuse are not seeded, it has no "
       "effect, which is warned of.",
       "1"},
      {"cache",
       {word<CacheMode>()},
       told("exact with exact discovery, seed with sampled"),
       "exact: only what has changed is worked out, and each frame is as from scratch, bit for bit; seed (goes with "
       "sampled only): what carried a path is tried first in the next frame; off: each frame from scratch.",
       R"("off")"},
  };
}

std::vector<KeyRule> keys_of_fields(const PropagationSettings& standards) {
  return {
      {"diffraction", {block(diffraction_block())}, told("the defaults of its keys"), "Which edges diffract.", ""},
      {"diffuse", {block(diffuse_block())}, told("off"), "Diffuse scattering.", ""},
      {"path_loss", {block(path_loss_block())}, told("free_space"), "Another law of distance.", ""},
      {"atmosphere", {block(atmosphere_block()), null()}, Absence{Absence::Kind::value, "null"}, "Gases and rain.", ""},
      {"antenna_array",
       {word<ArrayChannel>(), null()},
       standard(standards.antenna_array),
       "Elements of arrays: a phase for each, or a path for each pair; null: the default.",
       R"("plane_wave")"},
      {"min_path_gain_db",
       {number({-10'000.0, 1000.0}, "dB"), null()},
       Absence{Absence::Kind::value, "null"},
       "Weaker paths are dropped once their field is known; null: none.",
       "-150"},
      {"max_path_length_m",
       {number({1e-3, 1e9}, "m"), null()},
       Absence{Absence::Kind::value, "null"},
       "Longer paths are neither looked for nor reported (scattered power has all of its own); null: of any length. In "
       "the open, where each vehicle sees all others, work and memory then grow with the vehicles instead of with "
       "their "
       "square.",
       "300"},
      {"valid_until_limit_m",
       {number({1e-3, 100.0}, "m"), null()},
       Absence{Absence::Kind::value, "null"},
       "How far ends and bodies may move before a path appears or vanishes is worked out up to this, with cache exact "
       "and at most two interactions, one of them a diffraction, with line_of_sight or no transmissions, and without "
       "min_path_gain_db and max_path_length_m. Elsewhere it has no effect, which is warned of; null: it is not.",
       "0.5"},
  };
}

}  // namespace

const BlockRule& propagation_block() {
  static const BlockRule rule = [] {
    const PropagationSettings standards{};
    BlockRule propagation{"propagation", "Which paths are looked for, how, and what acts on them.", {}};
    for (auto* keys : {&keys_of_orders, &keys_of_discovery, &keys_of_fields}) {
      for (KeyRule& key : (*keys)(standards)) propagation.keys.push_back(std::move(key));
    }
    return propagation;
  }();
  return rule;
}

}  // namespace dcem::io::keys
