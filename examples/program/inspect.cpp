/// `dcem inspect`: what the engine sees in an OBJ file.
#include <iostream>

#include "options.hpp"

namespace dcem::program {

void inspect_scene(const InspectOptions& options) {
  const io::Inspection inspection = io::inspect_obj(options.obj, options.settings);
  std::cout << (options.json ? io::inspection_json(inspection) : io::inspection_table(inspection)) << std::flush;
  if (!std::cout) throw std::runtime_error("the output stream does not take the result");
  if (options.json) return;
  for (const std::string& warning : inspection.warnings) std::cerr << "warning: " << warning << '\n';
}

}  // namespace dcem::program
