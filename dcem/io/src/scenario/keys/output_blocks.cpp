#include "dcem/io/scenario.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"

namespace dcem::io::keys {

namespace {

const BlockRule& paths_block() {
  static const OutputSettings standards{};
  static const BlockRule rule{
      "output.paths",
      "The list of paths, paths.jsonl; a path takes some 800 bytes there.",
      {{"top", {whole_number(1, 999'999'999)}, told("all"), "Of each link the strongest paths alone, so many.", "10"},
       {"gzip", {boolean()}, standard(standards.paths_gzip), "Compressed, as paths.jsonl.gz.", "true"}}};
  return rule;
}

const BlockRule& pdp_block() {
  static const OutputSettings standards{};
  static const BlockRule rule{
      "output.pdp",
      "The power delay profile, pdp.csv.",
      {{"bin_s", {number({1e-15, 1.0}, "s")}, standard(standards.pdp_bin_s), "Width of a bin.", "1e-9"},
       {"mode",
        {word<PdpMode>()},
        standard(standards.pdp_mode),
        "incoherent: powers are summed; coherent: fields; band_limited: what a receiver of limited band sees.",
        R"("incoherent")"}}};
  return rule;
}

const BlockRule& cfr_block() {
  static const BlockRule rule{"output.cfr",
                              "The frequency response, cfr.npz.",
                              {{"bandwidth_hz",
                                {number({0.0, 1e12}, "Hz")},
                                required(),
                                "Around the carrier; at most twice the frequency.",
                                "100e6"},
                               {"points", {whole_number(1, 1e6)}, required(), "How many frequencies.", "256"}}};
  return rule;
}

const BlockRule& doppler_block() {
  static const OutputSettings standards{};
  static const BlockRule rule{
      "output.doppler",
      "The Doppler spectrum, doppler.csv.",
      {{"bin_hz", {number({1e-6, 1e9}, "Hz")}, standard(standards.doppler_bin_hz), "Width of a bin.", "10"}}};
  return rule;
}

ValueRule picture_formats() {
  return list(word({"png", "svg", "pdf"}), 1, "format");
}

const BlockRule& plots_block() {
  static const OutputSettings standards{};
  static const BlockRule rule{"output.plots",
                              "Pictures of links over time.",
                              {{"max_links",
                                {whole_number(1, 10'000)},
                                standard(standards.plots_max_links),
                                "So many links have pictures, the first ones.",
                                "20"},
                               {"pdp_frame",
                                {whole_number(0, 999'999'999)},
                                told("the middle one"),
                                "Frame of the single power delay profile.",
                                "40"},
                               {"formats",
                                {picture_formats()},
                                told("the usual one of each picture: png, svg or pdf"),
                                "Every picture is written in each of these.",
                                R"(["pdf"])"}}};
  return rule;
}

ValueRule map_files() {
  return list(word({"csv", "png", "npz", "asc", "svg", "pdf", "kml"}), 1, "ending");
}

const BlockRule& map_block() {
  static const MapPictureSettings standards{};
  static const BlockRule rule{
      "output.map",
      "The files of dcem map, and how maps are drawn.",
      {{"files",
        {map_files()},
        told("csv, npz and asc, maps as png, the distribution as svg"),
        "Which files are written; png, svg and pdf are of every picture, kml lays grids over the Earth and needs geo.",
        R"(["csv", "pdf"])"},
       {"range_dbm",
        {fixed_list(2, number({-1000.0, 1000.0}, "dBm"), "two numbers [lowest, highest]")},
        told("from the powers of the first frame with a value, the same for all maps of the run"),
        "Ends of the colours of power.",
        "[-120, -40]"},
       {"contours_db",
        {number({0.5, 1000.0}, "dB")},
        told("no lines"),
        "Lines of equal power, and of equal SINR, at its multiples.",
        "10"},
       {"finer_cells",
        {whole_number(1, 16)},
        standard(standards.finer_cells),
        "So many cells along each side of one are drawn, linear between the points.",
        "4"},
       {"hillshade",
        {boolean()},
        standard(standards.hillshade),
        "Light and shade on objects that are higher than the map.",
        "false"}}};
  return rule;
}

const BlockRule& html_block() {
  static const ViewerSettings standards{};
  static const BlockRule rule{
      "output.html",
      "The viewer, viewer.html: one file for a browser.",
      {{"max_rays", {whole_number(1, 1e7)}, standard(standards.max_rays), "So many paths over all frames.", "400000"},
       {"max_frames", {whole_number(1, 1e6)}, standard(standards.max_frames), "So many frames.", "2000"}}};
  return rule;
}

}  // namespace

const BlockRule& output_block() {
  static const OutputSettings standards{};
  static const BlockRule rule = [] {
    BlockRule output{"output",
                     "Which files are written: each key with true, or with the settings of its file.",
                     {yes_or_settings("paths", paths_block(), "Every path of every link, paths.jsonl."),
                      yes_or_no("links", standards.links, "A line for each link and frame, links.csv."),
                      yes_or_settings("pdp", pdp_block(), "The power delay profile, pdp.csv."),
                      yes_or_settings("cfr", cfr_block(), "The frequency response, cfr.npz."),
                      yes_or_settings("doppler", doppler_block(), "The Doppler spectrum, doppler.csv."),
                      yes_or_no("npz", standards.npz,
                                "All paths as arrays for NumPy, paths.npz, several times smaller than as lines."),
                      yes_or_settings("plots", plots_block(), "Pictures of links over time, SVG, PNG and PDF."),
                      {"map",
                       {only(true), map_files(), block(map_block())},
                       Absence{Absence::Kind::value, "true"},
                       "Which files dcem map writes: the usual ones, or those of a list; or how.",
                       R"(["csv", "png"])"},
                      yes_or_settings("html", html_block(), "The viewer, viewer.html.")}};
    for (KeyRule& key : exchange_keys()) output.keys.push_back(std::move(key));
    return output;
  }();
  return rule;
}

}  // namespace dcem::io::keys
