#include "map_files.hpp"

#include "dcem/channel/map_combination.hpp"
#include "dcem/channel/thermal_noise.hpp"
#include "dcem/io/map_distribution.hpp"
#include "dcem/io/map_writer.hpp"

namespace dcem::program {
namespace {

/// One frame's number for the file names, or nothing where there is only one frame.
std::optional<std::size_t> numbered(const Job& job, std::size_t frame) {
  return job.frames.count() > 1 ? std::optional(frame) : std::nullopt;
}

}  // namespace

template <typename Write>
void MapFiles::put(const std::string& name, Write&& write) {
  io::AtomicFile& file = folder_.open(name);
  write(file);
  file.close();
}

MapFiles::MapFiles(io::OutputFolder& folder, const Job& job, const Simulator& simulator, const Frame& frame,
                   std::vector<std::string> notes)
    : folder_(folder),
      wanted_(job.scenario.output.map),
      scene_(simulator.scene()),
      frame_(frame),
      number_(numbered(job, frame.index)),
      time_s_(number_ ? std::optional(frame.time_s) : std::nullopt),
      frequency_hz_(simulator.settings().frequency_hz),
      notes_(std::move(notes)) {
  if (job.scenario.noise) noise_dbm_ = noise_power_dbm(*job.scenario.noise);
}

void MapFiles::write(const std::vector<RadioMap>& maps) {
  for (const RadioMap& map : maps) write_one(map);
  if (maps.empty()) return;
  const CombinedMap combined = combine_maps(maps, noise_dbm_);
  write_best_server(combined);
  if (io::has_sinr(combined, noise_dbm_.has_value())) write_sinr(combined);
  const auto chart = [&](io::AtomicFile& file) { file.write(io::map_distribution_svg(maps, combined, time_s_)); };
  if (wanted_.svg) put(name_of(combined, distribution_part) + ".svg", chart);
}

std::string MapFiles::name_of(const CombinedMap& map, const char* part) const {
  return io::map_name(map.places.id(), part, number_);
}

void MapFiles::draw(const std::string& name, io::HeatMap picture) {
  picture.notes = notes_;
  put(name + ".png", [&](auto& file) { io::write_heat_map_png(picture, file); });
}

void MapFiles::write_one(const RadioMap& map) {
  const std::string name = io::map_name(map.places.id(), map.transmitter, number_);
  if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_map_csv(file, map, frequency_hz_); });
  if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_map_npz(file, map, frequency_hz_); });
  if (wanted_.asc && map.places.is_grid()) put(name + ".asc", [&](auto& file) { io::write_map_asc(file, map); });
  if (wanted_.png && map.places.is_grid()) {
    draw(name, io::map_picture(map, scene_, frame_, frequency_hz_, time_s_));
  }
}

void MapFiles::write_best_server(const CombinedMap& map) {
  const std::string name = name_of(map, best_server_part);
  if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_best_server_csv(file, map); });
  if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_best_server_npz(file, map); });
  if (wanted_.asc && map.places.is_grid())
    put(name + ".asc", [&](auto& file) { io::write_best_server_asc(file, map); });
  if (wanted_.png && map.places.is_grid()) {
    draw(name, io::best_server_picture(map, scene_, frame_, frequency_hz_, time_s_));
  }
}

void MapFiles::write_sinr(const CombinedMap& map) {
  const std::string name = name_of(map, sinr_part);
  if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_sinr_csv(file, map); });
  if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_sinr_npz(file, map); });
  if (wanted_.asc && map.places.is_grid()) put(name + ".asc", [&](auto& file) { io::write_sinr_asc(file, map); });
  if (wanted_.png && map.places.is_grid()) {
    draw(name, io::sinr_picture(map, scene_, frame_, frequency_hz_, noise_dbm_.has_value(), time_s_));
  }
}

}  // namespace dcem::program
