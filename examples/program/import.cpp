/// `dcem import`: other people's scenes made into scenarios.
#include <algorithm>
#include <array>
#include <iostream>
#include <string>
#include <string_view>

#include "options.hpp"

namespace dcem::program {
namespace {

io::SumoFiles sumo_files(const ImportOptions& options) {
  io::SumoFiles files{options.source, options.polygons, options.trace, {}};
  files.additional.assign(options.additional.begin(), options.additional.end());
  return files;
}

/// The kinds on which an option has an effect, where that is not all of them.
struct KindsOfOption {
  std::string_view option, kinds;
};
constexpr std::array kinds_of_options{KindsOfOption{"--poly", "sumo"},
                                      KindsOfOption{"--fcd", "sumo"},
                                      KindsOfOption{"--additional", "sumo"},
                                      KindsOfOption{"--default-height-m", "sumo, osm or gemv2"},
                                      KindsOfOption{"--level-height-m", "sumo or osm"},
                                      KindsOfOption{"--tree-height-m", "sumo or osm"},
                                      KindsOfOption{"--touching", "sumo, osm or gemv2"},
                                      KindsOfOption{"--snap-tolerance-m", "sumo, osm or gemv2"},
                                      KindsOfOption{"--smallest-house-sqm", "sumo, osm or gemv2"},
                                      KindsOfOption{"--ground-margin-m", "sumo, osm or gemv2"}};

/// An option that does nothing is a mistake.
void check_kind(const ImportOptions& options) {
  for (const auto& [option, kinds] : kinds_of_options) {
    if (kinds.find(options.kind) != std::string_view::npos || std::ranges::count(options.given, option) == 0) continue;
    throw UsageError(std::string(option) + " has no effect on '" + options.kind + "'", "kind " + std::string(kinds));
  }
}

io::ImportReport import_kind(const ImportOptions& options) {
  io::ImportSettings settings = options.settings;
  settings.touching = options.touching == "snap" ? io::TouchingHouses::snap : io::TouchingHouses::unite;
  if (options.kind == "sumo") return io::import_sumo(sumo_files(options), options.folder, settings);
  if (options.kind == "gemv2") return io::import_gemv2(options.source, options.folder, settings);
  if (options.kind == "sionna") return io::import_sionna(options.source, options.folder, settings);
  return io::import_osm(options.source, options.folder, settings);
}

}  // namespace

void import_scene(const ImportOptions& options) {
  check_kind(options);
  const io::ImportReport report = import_kind(options);
  if (options.quiet) return;
  std::cout << io::import_text(report) << "written: " << options.folder << "/scenario.json\n" << std::flush;
  if (!std::cout) throw std::runtime_error("the output stream does not take the result");
}

}  // namespace dcem::program
