#pragma once
/// The files of the maps of one frame.
#include <optional>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/combined_map_writer.hpp"
#include "job.hpp"

namespace dcem::program {

// What stands in the names of files in place of a transmitter.
inline constexpr const char* best_server_part = "best_server";
inline constexpr const char* sinr_part = "sinr";
inline constexpr const char* distribution_part = "distribution";

/// Writes the files of the maps of one frame. Pictures and rasters are of grids alone.
class MapFiles {
 public:
  /// `notes` stand at the foot of each picture.
  MapFiles(io::OutputFolder& folder, const Job& job, const Simulator& simulator, const Frame& frame,
           std::vector<std::string> notes);

  /// The maps of one grid or list, by transmitter. Throws OutputError.
  void write(const std::vector<RadioMap>& maps);

 private:
  template <typename Write>
  void put(const std::string& name, Write&& write);
  std::string name_of(const CombinedMap& map, const char* part) const;
  void draw(const std::string& name, io::HeatMap picture);
  void write_one(const RadioMap& map);
  void write_best_server(const CombinedMap& map);
  void write_sinr(const CombinedMap& map);

  io::OutputFolder& folder_;
  const io::MapOutputs wanted_;
  const Scene& scene_;
  const Frame& frame_;
  const std::optional<std::size_t> number_;  ///< in the names of files; absent where there is one frame
  const std::optional<double> time_s_;
  const double frequency_hz_;
  std::optional<double> noise_dbm_;
  const std::vector<std::string> notes_;
};

}  // namespace dcem::program
