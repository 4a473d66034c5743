#include "dcem/core/constants.hpp"
#include "dcem/em/antenna/antenna.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"

namespace dcem::io::keys {

namespace {

const BlockRule& grid_block() {
  static const BlockRule rule{
      "receivers[].grid",
      "Points in rows and columns, the receivers of one map.",
      {{"origin_m", {position_m()}, required(), "The first point, of the lowest x and y.", "[-50, -50, 1.5]"},
       {"spacing_m",
        {fixed_list(2, number({1e-6, 1e6}, "m"), "two numbers [along x, along y]")},
        required(),
        "From one point to the next.",
        "[1, 1]"},
       {"count",
        {fixed_list(2, whole_number(1, 1e9), "two whole numbers [columns, rows]")},
        required(),
        "How many points; with all samples at most 1e8.",
        "[100, 100]"},
       {"samples",
        {fixed_list(2, whole_number(1, 16), "two whole numbers [along x, along y]")},
        Absence{Absence::Kind::value, "[1, 1]"},
        "Values are means over so many points of each cell.",
        "[4, 4]"}}};
  return rule;
}

const BlockRule& pattern_block() {
  static const BlockRule rule{
      "antenna.pattern",
      "A pattern from a file.",
      {{"csv",
        {file()},
        chosen(),
        "A table azimuth_deg,zenith_deg,gain_dbi over the whole sphere.",
        R"("patch_element.csv")"},
       {"msi", {file()}, chosen(), "A file in MSI or NSMA format (WG16.99.050).", R"("panel.msi")"}},
      {{"file", {"csv", "msi"}}}};
  return rule;
}

const BlockRule& polarization_block() {
  static const BlockRule rule{
      "antenna.polarization",
      "A linear polarization at an angle.",
      {{"slant_deg", {number(any_angle_deg, "deg")}, required(), "From theta towards phi: 0 is V, 90 is H.", "45"}}};
  return rule;
}

const BlockRule& array_block() {
  static const AntennaArray standards{};
  static const auto most = static_cast<double>(most_array_elements);
  static const std::string together = " rows times columns are at most " + std::to_string(most_array_elements) + ".";
  static const BlockRule rule{
      "antenna.array",
      "Elements that are all alike, rows along z and columns along y of the antenna.",
      {{"rows", {whole_number(1, most)}, standard(standards.rows), "One above the other;" + together, "4"},
       {"columns", {whole_number(1, most)}, standard(standards.columns), "Side by side;" + together, "8"},
       {"spacing_wavelengths",
        {number({0.0, 1000.0, true}, "wavelengths")},
        standard(standards.spacing_wavelengths),
        "Between neighbours.",
        "0.5"}}};
  return rule;
}

std::vector<KeyRule> place_keys() {
  return {
      {"position_m", {position_m()}, chosen(), "A point.", "[0, 0, 10]"},
      {"positions_m",
       {list(position_m(), 1, "position")},
       chosen(),
       "Points; the devices are id[0], id[1], ...",
       "[[10, 0, 1.5], [20, 0, 1.5]]"},
      {"points_csv", {file()}, chosen(), "The same from a table with the columns x_m, y_m, z_m.", R"("route.csv")"},
      {"attach_to", {text()}, chosen(), "An object or a vehicle of the trace that the device rides on.", R"("car1")"},
      {"offset_m", {position_m()}, required("with attach_to"), "Where on it, in its axes.", "[0, 0, 1.6]"},
      {"sees_own_body",
       {boolean()},
       standard(false),
       "Whether for its links the object that it rides on is there.",
       "true"},
      {"velocity_mps",
       {three_numbers({-speed_of_light_mps, speed_of_light_mps}, "m/s")},
       told("it stands"),
       "Moves points, which hold at time.start_s; slower than light.",
       "[1.5, 0, 0]"},
      {"motion", {block(motion_block())}, chosen(), "It moves as an object does.", ""},
      {"antenna", {block(antenna_block())}, told("isotropic, vertical"), "What it sends or hears with.", ""},
  };
}

/// What transmitters and receivers have in common, and what the one has alone.
BlockRule device_block(const std::string& path, const std::string& meaning, std::vector<KeyRule> own_keys) {
  BlockRule device{path, meaning, {{"id", {identifier()}, required(), "Its name, once in its list.", R"("bs")"}}};
  for (KeyRule& key : place_keys()) device.keys.push_back(std::move(key));
  for (KeyRule& key : own_keys) device.keys.push_back(std::move(key));
  device.choices = {{"place", {"position_m", "positions_m", "points_csv", "attach_to", "motion"}}};
  return device;
}

}  // namespace

const BlockRule& transmitter_block() {
  static const BlockRule rule = [] {
    BlockRule device =
        device_block("transmitters[]", "Where it is, what it sends.",
                     {{"power_dbm", {number({-300.0, 200.0}, "dBm")}, chosen(), "Transmitted power.", "36.99"},
                      {"power_w", {number({1e-33, 1e17}, "W")}, chosen(), "The same in watts.", "5"}});
    device.choices.push_back({"power", {"power_dbm", "power_w"}});
    device.elsewhere = {{"grid", "goes with receivers only; expected position_m, attach_to or motion"}};
    return device;
  }();
  return rule;
}

const BlockRule& receiver_block() {
  static const BlockRule rule = [] {
    BlockRule device = device_block("receivers[]", "Where it is.",
                                    {{"grid", {block(grid_block())}, chosen(), "Points in rows and columns.", ""}});
    device.choices.front().keys.push_back("grid");
    for (const char* key : {"power_dbm", "power_w"}) {
      device.elsewhere.push_back({key, "does not go with a receiver; expected it in transmitters only"});
    }
    return device;
  }();
  return rule;
}

const BlockRule& antenna_block() {
  static const Antenna standards{};
  static const BlockRule rule{
      "antenna",
      "Of a transmitter or receiver: x is the boresight, z points up; it turns with what carries it.",
      {{"pattern",
        {word({"isotropic", "half_wave_dipole", "tr38901"}), block(pattern_block())},
        Absence{Absence::Kind::value, R"("isotropic")"},
        "Pattern of one element: by name, or from a file.",
        R"("half_wave_dipole")"},
       {"gain_dbi",
        {number({-200.0, 200.0}, "dBi")},
        standard(standards.gain_dbi),
        "On top of the pattern's own.",
        "3"},
       {"polarization",
        {word<PolarizationKind>(), block(polarization_block())},
        standard(standards.polarization.kind),
        "V, H, circular, or VH: both, where the 2 x 2 transfer is what is wanted.",
        R"("V")"},
       {"orientation_deg",
        {three_numbers(any_angle_deg, "deg", "three numbers [yaw, pitch, roll]")},
        Absence{Absence::Kind::value, "[0, 0, 0]"},
        "How the antenna is turned on what carries it.",
        "[90, 10, 0]"},
       {"array", {block(array_block())}, told("one element"), "Several elements.", ""}}};
  return rule;
}

}  // namespace dcem::io::keys
