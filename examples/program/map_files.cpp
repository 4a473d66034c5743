#include "map_files.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "dcem/io/map_distribution.hpp"
#include "dcem/io/map_overlay.hpp"
#include "dcem/io/map_writer.hpp"

namespace dcem::program {
namespace {

/// One frame's number for the file names, or nothing where there is only one frame.
std::optional<std::size_t> numbered(const Job& job, std::size_t frame) {
  return job.frames.count() > 1 ? std::optional(frame) : std::nullopt;
}

}  // namespace

std::optional<io::ValueRange> shared_range_dbm(const std::optional<io::ValueRange>& before,
                                               const std::vector<std::vector<RadioMap>>& maps) {
  if (before) return before;
  std::vector<double> powers_dbm;
  for (const std::vector<RadioMap>& of_one_place : maps) {
    for (const RadioMap& map : of_one_place) {
      for (const RadioMapPoint& point : map.points) {
        const std::optional<double>& power_dbm = point.statistics.power_incoherent_dbm;
        if (power_dbm && !point.obstructed && map.places.is_grid()) powers_dbm.push_back(*power_dbm);
      }
    }
  }
  return io::value_range(std::move(powers_dbm), "dBm");
}

void MapFiles::put(const std::string& name, std::function<void(io::AtomicFile&)> write) {
  jobs_.push_back([&file = folder_.open(name), write = std::move(write)] {
    write(file);
    file.close();
  });
}

/// Each file by one thread: a picture takes longer than a hundred points of a map.
void MapFiles::write_all() {
  pool_.for_each(jobs_.size(), [this](std::size_t number, unsigned) { jobs_[number](); });
  jobs_.clear();
}

MapFiles::MapFiles(io::OutputFolder& folder, const Job& job, const Simulator& simulator, const Frame& frame,
                   std::optional<io::ValueRange> range_dbm, std::vector<std::string> notes)
    : folder_(folder),
      wanted_(job.scenario.output.map),
      style_(job.scenario.output.map_pictures),
      range_dbm_(range_dbm),
      scene_(simulator.scene()),
      frame_(frame),
      number_(numbered(job, frame.index)),
      time_s_(number_ ? std::optional(frame.time_s) : std::nullopt),
      frequency_hz_(simulator.settings().frequency_hz),
      has_noise_(job.scenario.noise.has_value()),
      geo_(job.scenario.geo),
      notes_(std::move(notes)),
      pool_(simulator.pool()) {}

void MapFiles::write(const std::vector<RadioMap>& maps, const CombinedMap& combined) {
  relief_ = relief_of(combined);
  for (const RadioMap& map : maps) write_one(map);
  write_best_server(combined);
  if (io::has_sinr(combined, has_noise_)) write_sinr(combined);
  draw_distribution(maps, combined);
  write_all();
}

/// Pictures are of grids alone, as rasters are.
bool MapFiles::draws(const MapPlaces& places) const {
  return places.is_grid() && (wanted_.kml || !io::formats_or(wanted_.pictures, io::PictureFormat::png).empty());
}

/// Nothing where no picture shows it.
io::Relief MapFiles::relief_of(const CombinedMap& combined) const {
  const auto is_obstructed = [](const CombinedMapPoint& point) { return point.obstructed; };
  const bool shows = style_.hillshade && draws(combined.places) &&
                     std::any_of(combined.points.begin(), combined.points.end(), is_obstructed);
  return shows ? io::map_relief(combined.grid(), scene_, &pool_) : io::Relief{};
}

template <typename Draw>
void MapFiles::put_pictures(const std::string& name, io::PictureFormat usual, const Draw& draw) {
  for (const io::PictureFormat format : io::formats_or(wanted_.pictures, usual)) {
    put(name + "." + std::string(io::word_of(format)), [=](io::AtomicFile& file) { draw(file, format); });
  }
}

/// Left out where this build draws no charts.
void MapFiles::draw_distribution(const std::vector<RadioMap>& maps, const CombinedMap& combined) {
  if (!io::can_draw()) return;
  const auto charts =
      std::make_shared<const std::vector<io::LineChart>>(io::map_distribution_charts(maps, combined, time_s_));
  put_pictures(name_of(combined, distribution_part), io::PictureFormat::svg,
               [=](io::AtomicFile& file, io::PictureFormat format) { io::write_line_charts(*charts, file, format); });
}

std::string MapFiles::name_of(const CombinedMap& map, const char* part) const {
  return io::map_name(map.places.id(), part, number_);
}

void MapFiles::draw(const std::string& name, io::HeatMap picture) {
  picture.notes = notes_;
  picture.relief = relief_;
  if (picture.categories.empty()) {
    picture.contour_step = style_.contours_db;
    if (style_.finer_cells > 1) picture = io::refined(picture, style_.finer_cells);
  }
  const auto shared = std::make_shared<const io::HeatMap>(std::move(picture));
  put_pictures(name, io::PictureFormat::png,
               [=](io::AtomicFile& file, io::PictureFormat format) { io::write_heat_map(*shared, file, format); });
  if (!wanted_.kml) return;
  io::AtomicFile& kml = folder_.open(name + ".kml");
  put(name + "_cells.png", [=, this, &kml](io::AtomicFile& cells) {
    io::write_ground_overlay(kml, cells, *shared, *geo_);
    kml.close();
  });
}

void MapFiles::write_one(const RadioMap& map) {
  const std::string name = io::map_name(map.places.id(), map.transmitter, number_);
  if (wanted_.csv) put(name + ".csv", [this, &map](auto& file) { io::write_map_csv(file, map, frequency_hz_); });
  if (wanted_.npz) put(name + ".npz", [this, &map](auto& file) { io::write_map_npz(file, map, frequency_hz_); });
  if (wanted_.asc && map.places.is_grid()) put(name + ".asc", [&map](auto& file) { io::write_map_asc(file, map); });
  if (!draws(map.places)) return;
  io::HeatMap picture = io::map_picture(map, scene_, frame_, frequency_hz_, time_s_);
  picture.range = range_dbm_;
  draw(name, std::move(picture));
}

void MapFiles::write_best_server(const CombinedMap& map) {
  const std::string name = name_of(map, best_server_part);
  if (wanted_.csv) put(name + ".csv", [&map](auto& file) { io::write_best_server_csv(file, map); });
  if (wanted_.npz) put(name + ".npz", [&map](auto& file) { io::write_best_server_npz(file, map); });
  if (wanted_.asc && map.places.is_grid())
    put(name + ".asc", [&map](auto& file) { io::write_best_server_asc(file, map); });
  if (draws(map.places)) draw(name, io::best_server_picture(map, scene_, frame_, frequency_hz_, time_s_));
}

void MapFiles::write_sinr(const CombinedMap& map) {
  const std::string name = name_of(map, sinr_part);
  if (wanted_.csv) put(name + ".csv", [&map](auto& file) { io::write_sinr_csv(file, map); });
  if (wanted_.npz) put(name + ".npz", [&map](auto& file) { io::write_sinr_npz(file, map); });
  if (wanted_.asc && map.places.is_grid()) put(name + ".asc", [&map](auto& file) { io::write_sinr_asc(file, map); });
  if (draws(map.places)) draw(name, io::sinr_picture(map, scene_, frame_, frequency_hz_, has_noise_, time_s_));
}

}  // namespace dcem::program
