#pragma once
/// A run for Google Earth: links.kml. Private to dcem::io.
///
/// OGC KML 2.3 (docs.opengeospatial.org/is/12-007r2) with gx:Track of Google's extensions, which every reader knows.
/// Each link of a frame is a line from device to device until the next frame, at a height and in a colour that show its
/// incoherent power, as the tool GEMV² draws links; exact powers stand in its ExtendedData.
#include <map>
#include <string>
#include <vector>

#include "dcem/io/geo_anchor.hpp"
#include "dcem/io/src/exchange/frame_export.hpp"

namespace dcem::io {

class KmlExport : public FrameExport {
 public:
  explicit KmlExport(const ExportContext& context);
  void add(const FrameResult& frame, const Frame& instant) override;
  void finish() override;

 private:
  /// A link of the frame before, whose end is known when the next one comes.
  struct Line {
    std::size_t transmitter = 0, receiver = 0;
    std::optional<double> power_dbm{};
    double power_incoherent_dbm = 0.0;
    Vec3 from_m{0.0}, to_m{0.0};
  };
  struct TrackPoint {
    double time_s = 0.0;
    Vec3 position_m{0.0};
    double yaw_rad = 0.0;
  };

  void write_head();
  void add_links(const FrameResult& frame, const Frame& instant);
  void write_lines(double until_s);
  void append_line(std::string& text, const Line& line, const std::string& span) const;
  void add_things(const Frame& instant, std::map<std::string, TrackPoint>& things);
  void follow(const std::map<std::string, TrackPoint>& things);
  void write_track(const std::string& name, const std::vector<TrackPoint>& points);
  void write_place(const std::string& name, const Vec3& position_m);
  GeoPlace place(const Vec3& position_m) const { return place_on_earth(anchor_, position_m.x, position_m.y); }
  std::string coordinates(const Vec3& position_m, double height_m, char separator) const;
  std::string instant_text(double time_s) const;
  double share_of(double power_dbm) const;

  AtomicFile& file_;
  const Scene& scene_;
  std::span<const Device> receivers_;
  KmlSettings settings_;
  GeoAnchor anchor_;
  std::int64_t start_us_ = 0;
  std::vector<double> times_s_;  // the last two at most
  std::vector<Line> lines_;
  std::map<std::string, std::vector<TrackPoint>> tracks_;
  std::size_t track_points_ = 0;
};

}  // namespace dcem::io
