/// `dcem import`: other people's scenes made into scenarios.
#include <iostream>

#include "options.hpp"

namespace dcem::program {
namespace {

io::SumoFiles sumo_files(const ImportOptions& options) {
  io::SumoFiles files{options.source, options.polygons, options.trace, {}};
  files.additional.assign(options.additional.begin(), options.additional.end());
  return files;
}

/// An option that does nothing is a mistake.
void check_kind(const ImportOptions& options) {
  if (options.kind == "sumo") return;
  const bool has_any = !options.polygons.empty() || !options.trace.empty() || !options.additional.empty();
  if (has_any) throw UsageError("--poly, --fcd and --additional have no effect on '" + options.kind + "'", "kind sumo");
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
