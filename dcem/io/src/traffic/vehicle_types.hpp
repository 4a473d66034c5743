#pragma once
/// How large vehicles are: SUMO's vehicle types. Private to dcem::io.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

/// Vehicle types by their id. SUMO's own (DEFAULT_VEHTYPE, …) are there from the start; a file may define them anew.
class VehicleTypes {
 public:
  VehicleTypes();

  /// Adds every `vType` of an XML file (plain or .gz), wherever it stands in it. What a type leaves out is SUMO's
  /// default for its `vClass`. Throws InputError with the line.
  void read(const std::filesystem::path& file);

  /// Length, width and height in metres; nothing where the type is unknown.
  const Vec3* find_size_m(const std::string& id) const;
  std::vector<std::string> ids() const;

 private:
  struct Type {
    Vec3 size_m{0.0};
    std::string place;  ///< FILE:LINE of the definition; empty for SUMO's own
  };

  friend class VehicleTypeFile;
  std::map<std::string, Type> types_;
};

}  // namespace dcem::io
