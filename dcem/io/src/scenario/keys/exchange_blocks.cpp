#include "dcem/io/scenario.hpp"
#include "dcem/io/src/exchange/column_export.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"

namespace dcem::io::keys {

namespace {

/// A default that `standard` has no form for.
Absence as_json(std::string text) {
  return {Absence::Kind::value, std::move(text)};
}

const BlockRule& kml_block() {
  static const KmlSettings standards{};
  static const BlockRule rule{"output.kml",
                              "Links and vehicles for Google Earth, links.kml; needs geo.",
                              {{"range_dbm",
                                {fixed_list(2, number({-1000.0, 1000.0}, "dBm"), "two numbers [lowest, highest]")},
                                as_json("[-120, -40]"),
                                "Ends of the colours; lines stand on the ground at the lower one.",
                                "[-110, -50]"},
                               {"metres_per_db",
                                {number({0.0, 1000.0}, "m")},
                                standard(standards.metres_per_db),
                                "How high lines stand above the ground for each dB.",
                                "0.5"},
                               {"start",
                                {line()},
                                as_json(R"("2000-01-01T00:00:00Z")"),
                                "Date and time (UTC) of the scenario's second 0.",
                                R"("2026-05-04T12:00:00Z")"}}};
  return rule;
}

const BlockRule& gltf_block() {
  static const GltfSettings standards{};
  static const BlockRule rule{
      "output.gltf",
      "The scene of one frame with its rays, scene.glb, for Blender and other programs.",
      {{"frame",
        {whole_number(0, 999'999'999)},
        told("the first one"),
        "Whose rays, counted as in the scenario.",
        "40"},
       {"max_rays", {whole_number(1, 1e7)}, standard(standards.max_rays), "So many rays, the strongest.", "5000"},
       {"range_db",
        {number({1.0, 1000.0}, "dB")},
        standard(standards.range_db),
        "What the colours span below the strongest ray.",
        "40"}}};
  return rule;
}

const BlockRule& hdf5_block() {
  static const BlockRule rule{
      "output.hdf5",
      "The paths of large runs as columns, paths.h5, appended frame by frame.",
      {{"columns",
        {list(word(path_column_names()), 1, "column")},
        told("delay, amplitude, Doppler and the four angles: 64 bytes a path, 32 in single precision"),
        "Which columns there are.",
        R"(["delay_s", "received_power_dbm"])"},
       {"precision",
        {word({"single", "double"})},
        as_json(R"("double")"),
        "Of the columns; single halves the file.",
        R"("single")"}}};
  return rule;
}

}  // namespace

std::vector<KeyRule> exchange_keys() {
  return {
      yes_or_no("mat", false, "The arrays of npz for MATLAB and Octave, paths.mat."),
      yes_or_settings("hdf5", hdf5_block(), "Paths of large runs as columns, 32 to 64 bytes each, paths.h5."),
      yes_or_no("qd", false, "Ray by ray as ns-3's qd-channel reads it, folder qd."),
      yes_or_no("p2m", false, "Paths as Wireless InSite lists them, folder p2m."),
      yes_or_no("deepmimo", false, "A scenario of DeepMIMO 4, folder deepmimo."),
      yes_or_settings("kml", kml_block(), "Links and vehicles for Google Earth, links.kml; needs geo."),
      yes_or_settings("gltf", gltf_block(), "The scene of one frame with its rays, scene.glb."),
  };
}

const BlockRule& geo_block() {
  static const BlockRule rule{
      "geo",
      "Where on the Earth (WGS 84) the scene lies: its origin, or a zone of UTM. Where both are there, UTM holds.",
      {{"origin_lat_deg",
        {number({-89.0, 89.0}, "degrees")},
        told("crs and offset_m say where"),
        "Latitude of the scene's origin; y is north there.",
        "50.868"},
       {"origin_lon_deg",
        {number({-180.0, 180.0}, "degrees")},
        told("crs and offset_m say where"),
        "Longitude of the scene's origin.",
        "9.708"},
       {"crs", {line()}, told("the origin says where"), "A zone of UTM, north or south.", R"("utm32n")"},
       {"offset_m",
        {fixed_list(2, number({-1e8, 1e8}, "m"), "two numbers [easting, northing]")},
        told("the origin says where"),
        "What x and y lack to easting and northing.",
        "[549800, 5635400]"}}};
  return rule;
}

}  // namespace dcem::io::keys
