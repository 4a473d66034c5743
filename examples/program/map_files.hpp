#pragma once
/// The files of the maps of one frame.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/combined_map_writer.hpp"
#include "job.hpp"

namespace dcem::program {

// What stands in the names of files in place of a transmitter.
inline constexpr const char* best_server_part = "best_server";
inline constexpr const char* sinr_part = "sinr";
inline constexpr const char* distribution_part = "distribution";

/// The colours of power of all maps of a run: those of the scenario, or of the first maps that have a value.
std::optional<io::ValueRange> shared_range_dbm(const std::optional<io::ValueRange>& before,
                                               const std::vector<std::vector<RadioMap>>& maps);

/// Writes the files of the maps of one frame. Pictures and rasters are of grids alone.
class MapFiles {
 public:
  /// `range_dbm` is that of the colours of power, and `notes` stand at the foot of each picture.
  MapFiles(io::OutputFolder& folder, const Job& job, const Simulator& simulator, const Frame& frame,
           std::optional<io::ValueRange> range_dbm, std::vector<std::string> notes);

  /// The maps of one grid or list, by transmitter, and what they are together. Throws OutputError.
  void write(const std::vector<RadioMap>& maps, const CombinedMap& combined);

 private:
  /// Opens a file, for `write(file)` to be called when all are open.
  void put(const std::string& name, std::function<void(io::AtomicFile&)> write);
  void write_all();
  std::string name_of(const CombinedMap& map, const char* part) const;
  template <typename Draw>
  void put_pictures(const std::string& name, io::PictureFormat usual, const Draw& draw);
  void draw(const std::string& name, io::HeatMap picture);
  void draw_distribution(const std::vector<RadioMap>& maps, const CombinedMap& combined);
  bool draws(const MapPlaces& places) const;
  io::Relief relief_of(const CombinedMap& combined) const;
  void write_one(const RadioMap& map);
  void write_best_server(const CombinedMap& map);
  void write_sinr(const CombinedMap& map);

  io::OutputFolder& folder_;
  const io::MapOutputs wanted_;
  const io::MapPictureSettings style_;
  const std::optional<io::ValueRange> range_dbm_;
  const Scene& scene_;
  const Frame& frame_;
  const std::optional<std::size_t> number_;  ///< in the names of files; absent where there is one frame
  const std::optional<double> time_s_;
  const double frequency_hz_;
  const bool has_noise_;
  const std::optional<io::GeoAnchor> geo_;
  const std::vector<std::string> notes_;
  ThreadPool& pool_;
  io::Relief relief_;                        ///< of the grid whose maps are written
  std::vector<std::function<void()>> jobs_;  ///< a file each; what they refer to lasts until all are written
};

}  // namespace dcem::program
