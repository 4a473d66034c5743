#include "dcem/io/scenario.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"

namespace dcem::io::keys {

namespace {

const BlockRule& scene_block() {
  static const SurfaceSettings standards{};
  static const ObjSettings obj{};
  static const BlockRule rule{
      "scene",
      "The scenery: what stands.",
      {{"obj", {file()}, required(), "The scene, an OBJ file; its MTL files hold the materials.", R"("town.obj")"},
       {"up",
        {word<UpAxis>()},
        standard(obj.up),
        "The file's axis that points up; with y its (x, y, z) becomes (x, -z, y).",
        R"("z")"},
       {"unit_m", {number({1e-9, 1e6}, "m")}, standard(obj.unit_m), "Length of one unit of the file.", "0.001"},
       {"weld_tolerance_m",
        {number({1e-9, 1.0}, "m")},
        standard(standards.weld_tolerance_m),
        "Vertices no further apart are one; a device this close to a facet is mounted on it.",
        "1e-4"},
       {"planarity_tolerance_m",
        {number({1e-9, 1.0}, "m")},
        standard(standards.planarity_tolerance_m),
        "How far a corner may lie from its neighbour's plane for both to be one facet.",
        "1e-3"}}};
  return rule;
}

const BlockRule& itu_block() {
  static const ItuSettings standards{};
  static const BlockRule rule{
      "itu",
      "Which table of ITU-R P.2040 counts.",
      {{"revision", {whole_number(3, 4)}, standard(standards.revision), "3 is that of 2023, 4 that of 2025.", "3"},
       {"allow_extrapolation",
        {boolean()},
        standard(standards.allow_extrapolation),
        "Outside the table's frequencies: false is an error, true a warning.",
        "false"}}};
  return rule;
}

const BlockRule& time_block() {
  static const TimeSettings standards{};
  static const BlockRule rule{
      "time",
      "The instants of the frames. With mobility, what is left out comes from the trace.",
      {{"start_s", {number(any_instant_s, "s")}, standard(standards.start_s), "Instant of the first frame.", "0"},
       {"step_s", {number({0.0, 1e9, true}, "s")}, standard(standards.step_s), "From one frame to the next.", "0.1"},
       {"frames", {whole_number(1, 1e9)}, standard(standards.frames), "How many frames.", "100"}}};
  return rule;
}

const BlockRule& vehicle_share_block() {
  static const BlockRule rule{
      "mobility.devices.vehicles",
      "A share of all vehicles of the trace, drawn by their ids.",
      {{"share", {number({0.0, 1.0})}, required(), "How many of all, in the mean.", "0.2"},
       {"seed", {whole_number(0, 9e18)}, Absence{Absence::Kind::value, "1"}, "Another seed draws others.", "1"}}};
  return rule;
}

const BlockRule& vehicle_devices_block() {
  static const BlockRule rule{
      "mobility.devices",
      "A device over the middle of the roof of each chosen vehicle, with the vehicle's id; it transmits and receives. "
      "Of "
      "two such devices there is one link, from the lesser id.",
      {{"vehicles",
        {word({"all"}), list(text(), 1, "id of a vehicle"), block(vehicle_share_block())},
        required(),
        "Which vehicles.",
        R"("all")"},
       {"height_above_roof_m",
        {number({0.0, 1000.0}, "m")},
        Absence{Absence::Kind::value, "0.1"},
        "Of the antenna.",
        "0.1"},
       {"power_dbm", {number({-300.0, 200.0}, "dBm")}, required(), "Transmitted power.", "23"},
       {"antenna", {block(antenna_block())}, told("isotropic, vertical"), "What it sends and hears with.", ""}}};
  return rule;
}

const BlockRule& links_block() {
  static const BlockRule rule{"links",
                              "Which links of dcem run there are; one at least of both keys. Maps have all.",
                              {{"range_m",
                                {number({1e-3, 1e9}, "m")},
                                told("at any distance"),
                                "Only between ends that are no farther apart, in each frame.",
                                "150"},
                               {"pairs",
                                {list(fixed_list(2, text(), "two ids [transmitter, receiver]"), 1, "pair")},
                                told("any transmitter with any receiver"),
                                "Only these; of two vehicles with devices in any order.",
                                R"([["bs", "ue"]])"}}};
  return rule;
}

const BlockRule& mobility_block() {
  static const BlockRule rule{
      "mobility",
      "Vehicles of a SUMO trace, each a box of the size that its type has.",
      {{"sumo_fcd",
        {file()},
        required(),
        "SUMO's FCD output, plain or .gz; it is streamed. In longitude and latitude with the block geo.",
        R"("trace.fcd.xml")"},
       {"vehicle_types",
        {file(), list(file(), 1, "file of vehicle types")},
        told("no type is known but SUMO's own"),
        "SUMO's additional or route files with the vType elements: one file, or several.",
        R"("vtypes.add.xml")"},
       {"material", {line()}, required(), "What the vehicles are made of.", R"("metal")"},
       {"devices",
        {block(vehicle_devices_block())},
        told("no device but those in transmitters and receivers"),
        "A device on each chosen vehicle.",
        ""}}};
  return rule;
}

const BlockRule& noise_block() {
  static const NoiseSettings standards{};
  static const BlockRule rule{
      "noise",
      "Noise of the receivers, for the SINR of maps; without it, maps show the SIR.",
      {{"bandwidth_hz", {number({0.0, 1e12, true}, "Hz")}, required(), "Noise bandwidth.", "20e6"},
       {"noise_figure_db",
        {number({0.0, 100.0}, "dB")},
        standard(standards.noise_figure_db),
        "What the receiver adds.",
        "7"},
       {"temperature_k",
        {number({0.0, 1e6, true}, "K")},
        standard(standards.temperature_k),
        "Of the antenna and its surroundings.",
        "290"}}};
  return rule;
}

const BlockRule& tree_block() {
  static const WideTreeSettings standards{};
  static const BlockRule rule{"tree",
                              "How the tree over the triangles is built and kept. None of this changes a result.",
                              {{"policy",
                                {word<TreePolicy>()},
                                standard(standards.policy),
                                "What is done when something has moved.",
                                R"("adaptive")"},
                               {"quality",
                                {word<WideQuality>()},
                                standard(standards.build.quality),
                                "How long a build may take; high is for scenery that stands still.",
                                R"("good")"},
                               {"build_threads",
                                {whole_number(0, 4096)},
                                standard(standards.build.threads),
                                "Of a build; 0 is all cores.",
                                "1"},
                               {"huge_pages",
                                {boolean()},
                                standard(standards.build.huge_pages),
                                "Whether the system is asked for huge pages where the tree is large.",
                                "true"}}};
  return rule;
}

std::vector<KeyRule> keys_of_the_scene() {
  return {
      {"scene", {block(scene_block())}, required(), "The scenery.", ""},
      {"materials",
       {entries(material_block())},
       told("the MTL files and the names say all"),
       "Materials by their names; they override or complete those of the MTL files.",
       ""},
      {"itu", {block(itu_block())}, told("revision 3, no extrapolation"), "Which table of materials counts.", ""},
      {"frequency_hz", {number({0.0, 1e15, true}, "Hz")}, required(), "Carrier frequency.", "28e9"},
      {"time", {block(time_block())}, told("one frame at 0 s, or the steps of the trace"), "When frames are.", ""},
      {"objects",
       {list(block(object_block()), 0, "object")},
       told("nothing moves but traffic"),
       "What may move: meshes, boxes, foliage.",
       ""},
      {"mobility", {block(mobility_block())}, told("no traffic"), "Vehicles of a SUMO trace.", ""},
  };
}

std::vector<KeyRule> keys_of_the_radio() {
  return {
      {"transmitters",
       {list(block(transmitter_block()), 1, "device")},
       told("those of mobility.devices; there must be one"),
       "What sends.",
       ""},
      {"receivers",
       {list(block(receiver_block()), 1, "device")},
       told("those of mobility.devices; there must be one"),
       "What hears.",
       ""},
      {"links",
       {word({"all"}), block(links_block())},
       Absence{Absence::Kind::value, R"("all")"},
       "Which transmitter goes with which receiver: all with all, or some, but never a device with itself.",
       R"("all")"},
      {"propagation",
       {block(propagation_block())},
       told("the defaults of its keys"),
       "Which paths are looked for, and how.",
       ""},
      {"output", {block(output_block())}, told("links"), "Which files are written.", ""},
      {"noise", {block(noise_block())}, told("no noise"), "Noise of the receivers.", ""},
      {"tree", {block(tree_block())}, told("the defaults of its keys"), "How the tree is built and kept.", ""},
      {"geo",
       {block(geo_block())},
       told("a plane without a place on the Earth"),
       "Where on the Earth the scene lies.",
       ""},
  };
}

}  // namespace

const BlockRule& scenario_block() {
  static const BlockRule rule = [] {
    BlockRule all{
        "",
        "The whole file is one object in JSON; comments, // and /* */, are read. File names are relative to it.",
        {{"$schema",
          {text()},
          told("nothing"),
          "Address of the JSON Schema, for editors; not read.",
          R"("dcem-scenario-1.schema.json")"},
         {"format", {word({"dcem-scenario/1"})}, required(), "Says that this is a scenario.", R"("dcem-scenario/1")"}}};
    for (KeyRule& key : keys_of_the_scene()) all.keys.push_back(std::move(key));
    for (KeyRule& key : keys_of_the_radio()) all.keys.push_back(std::move(key));
    return all;
  }();
  return rule;
}

const BlockRule& command_line_block() {
  static const BlockRule rule = [] {
    BlockRule options{"", "What the command line overrides.", {}};
    for (const char* key : {"discovery", "cache", "rays", "seed"}) {
      options.keys.push_back(*find_key(propagation_block(), key));
    }
    options.keys.push_back(*find_key(scenario_block(), "output"));
    options.keys.push_back(*find_key(scenario_block(), "frequency_hz"));
    options.keys.back().name = "frequency";
    options.keys.back().absence = told("that of the scenario");
    for (KeyRule& key : options.keys) key.name = "--" + key.name;
    return options;
  }();
  return rule;
}

}  // namespace dcem::io::keys
