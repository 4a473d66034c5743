#pragma once
/// Recorded poses: `t_s,id,x_m,y_m,z_m,yaw_deg[,pitch_deg,roll_deg]`, one row per instant and id. Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "dcem/world/motion.hpp"

namespace dcem::io {

/// The rows of one file, by id.
class PosesCsv {
 public:
  /// Reads the file. Columns are found by name, in any order; rows of different ids may be mixed, those of one id have
  /// increasing times. Throws InputError with the line.
  explicit PosesCsv(const std::filesystem::path& file);

  /// The poses of an id, which counts as used from now on; nothing where the file has no row of it.
  const WaypointMotion* take(const std::string& id);
  /// Throws InputError at the first row of an id that was never taken.
  void check_all_taken() const;
  /// The id with the fewest edits to `id`. Precondition: the file has a row.
  std::string nearest_id(const std::string& id) const;
  bool empty() const { return tracks_.empty(); }

 private:
  struct Track {
    WaypointMotion motion;
    std::size_t first_line = 0;
    bool taken = false;
  };

  std::string name_;
  std::map<std::string, Track> tracks_;
};

}  // namespace dcem::io
