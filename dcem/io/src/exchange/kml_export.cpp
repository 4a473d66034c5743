#include "dcem/io/src/exchange/kml_export.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "dcem/core/units.hpp"
#include "dcem/io/src/exchange/calendar_time.hpp"
#include "dcem/io/src/exchange/xml_text.hpp"
#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

constexpr int colour_steps = 64;
constexpr std::size_t most_track_points = 200'000;  // kept in memory; then the tracks so far are written

/// KML counts alpha first and red last.
std::string kml_colour(double share, int alpha) {
  const Colour colour = viridis(share);
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%02x%02x%02x%02x", alpha, colour.blue, colour.green, colour.red);
  return text.data();
}

std::string style_of(int step) {
  const double share = static_cast<double>(step) / (colour_steps - 1);
  return "<Style id=\"p" + std::to_string(step) + "\"><LineStyle><color>" + kml_colour(share, 255) +
         "</color><width>3</width></LineStyle><PolyStyle><color>" + kml_colour(share, 90) +
         "</color></PolyStyle></Style>\n";
}

bool stands(const Motion& motion) {
  const auto* linear = std::get_if<LinearMotion>(&motion);
  return linear != nullptr && linear->velocity_mps == Vec3(0.0);
}

void append_value(std::string& text, const char* name, double value) {
  text.append("<Data name=\"").append(name).append("\"><value>");
  append_number(text, value);
  text += "</value></Data>";
}

}  // namespace

KmlExport::KmlExport(const ExportContext& context)
    : file_(context.folder.open("links.kml")),
      scene_(context.scene),
      receivers_(context.receivers),
      settings_(context.output.exchange.kml_settings),
      anchor_(context.facts.geo.value()),
      start_us_(settings_.start_us) {
  write_head();
}

void KmlExport::write_head() {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n"
      "<Document>\n<name>Links</name>\n<description>Colour and height of a line: incoherent received power, from " +
      format_fixed(settings_.range_dbm[0], 1) + " to " + format_fixed(settings_.range_dbm[1], 1) + " dBm, " +
      format_fixed(settings_.metres_per_db, 3) + " m for each dB.</description>\n";
  for (int step = 0; step < colour_steps; ++step) text += style_of(step);
  file_.write(text);
}

void KmlExport::add(const FrameResult& frame, const Frame& instant) {
  if (!times_s_.empty()) write_lines(frame.time_s);
  const bool is_first = times_s_.empty();
  times_s_.push_back(frame.time_s);
  if (times_s_.size() > 2) times_s_.erase(times_s_.begin());
  add_links(frame, instant);
  if (is_first) {
    for (const auto devices : {scene_.transmitters(), receivers_}) {
      for (const Device& device : devices) {
        if (!device.attachment && stands(device.motion)) {
          write_place(device.id, scene_.device_state(device, instant).position_m);
        }
      }
    }
  }
  std::map<std::string, TrackPoint> things;
  add_things(instant, things);
  follow(things);
}

/// Links at which nothing arrives have no line.
void KmlExport::add_links(const FrameResult& frame, const Frame& instant) {
  lines_.clear();
  for (const LinkResult& link : frame.links) {
    const std::optional<double>& power_dbm = link.statistics.power_incoherent_dbm;
    if (!power_dbm || !std::isfinite(*power_dbm)) continue;
    const DeviceState from = scene_.device_state(scene_.transmitters()[link.transmitter], instant);
    const DeviceState to = scene_.device_state(receivers_[link.receiver], instant);
    lines_.push_back(
        {link.transmitter, link.receiver, link.statistics.power_dbm, *power_dbm, from.position_m, to.position_m});
  }
}

void KmlExport::write_lines(double until_s) {
  if (lines_.empty()) return;
  const std::string begin = instant_text(times_s_.back());
  const std::string span = "<TimeSpan><begin>" + begin + "</begin><end>" + instant_text(until_s) + "</end></TimeSpan>";
  std::string text = "<Folder><name>" + begin + "</name>\n";
  for (const Line& line : lines_) append_line(text, line, span);
  file_.write(text + "</Folder>\n");
}

void KmlExport::append_line(std::string& text, const Line& line, const std::string& span) const {
  const double share = share_of(line.power_incoherent_dbm);
  const double height_m = std::max(0.0, line.power_incoherent_dbm - settings_.range_dbm[0]) * settings_.metres_per_db;
  const std::string& tx = scene_.transmitters()[line.transmitter].id;
  const std::string& rx = receivers_[line.receiver].id;
  text += "<Placemark><name>" + xml_text(tx) + " to " + xml_text(rx) + "</name>" + span + "<styleUrl>#p" +
          std::to_string(std::lround(share * (colour_steps - 1))) + "</styleUrl><ExtendedData>";
  text += "<Data name=\"tx\"><value>" + xml_text(tx) + "</value></Data><Data name=\"rx\"><value>" + xml_text(rx) +
          "</value></Data>";
  if (line.power_dbm) append_value(text, "power_dbm", *line.power_dbm);
  append_value(text, "power_incoherent_dbm", line.power_incoherent_dbm);
  text += "</ExtendedData><LineString><extrude>1</extrude><altitudeMode>relativeToGround</altitudeMode><coordinates>";
  text += coordinates(line.from_m, height_m, ',') + " " + coordinates(line.to_m, height_m, ',');
  text += "</coordinates></LineString></Placemark>\n";
}

/// What moves: objects, and devices that do not ride on one.
void KmlExport::add_things(const Frame& instant, std::map<std::string, TrackPoint>& things) {
  for (std::size_t body = 1; body < instant.bodies.size(); ++body) {
    const BodyState& state = instant.bodies[body];
    const Body& known = scene_.body(BodyId(body));
    if (!state.present || (!known.is_slot && stands(known.motion))) continue;
    const Pose& pose = state.placement.pose;
    things[known.is_slot ? state.occupant : known.id] = {instant.time_s, pose.position_m, pose.yaw_rad};
  }
  for (const auto devices : {scene_.transmitters(), receivers_}) {
    for (const Device& device : devices) {
      if (device.attachment || stands(device.motion)) continue;
      things.try_emplace(device.id, TrackPoint{instant.time_s, scene_.device_state(device, instant).position_m, 0.0});
    }
  }
}

/// A track ends where its vehicle leaves; one that grew too long goes on in another piece, from its last point.
void KmlExport::follow(const std::map<std::string, TrackPoint>& things) {
  for (auto track = tracks_.begin(); track != tracks_.end();) {
    if (things.contains(track->first)) {
      ++track;
      continue;
    }
    write_track(track->first, track->second);
    track_points_ -= track->second.size();
    track = tracks_.erase(track);
  }
  for (const auto& [name, point] : things) tracks_[name].push_back(point);
  track_points_ += things.size();
  if (track_points_ < std::max(most_track_points, 4 * things.size())) return;
  for (auto& [name, points] : tracks_) {
    write_track(name, points);
    points = {points.back()};
  }
  track_points_ = tracks_.size();
}

void KmlExport::write_track(const std::string& name, const std::vector<TrackPoint>& points) {
  std::string text =
      "<Placemark><name>" + xml_text(name) + "</name><gx:Track><altitudeMode>relativeToGround</altitudeMode>\n";
  for (const TrackPoint& point : points) text += "<when>" + instant_text(point.time_s) + "</when>\n";
  for (const TrackPoint& point : points) {
    text += "<gx:coord>" + coordinates(point.position_m, point.position_m.z, ' ') + "</gx:coord>\n";
  }
  for (const TrackPoint& point : points) {  // a heading is counted clockwise from north
    double heading_deg = 90.0 - radians_to_degrees(point.yaw_rad) + place(point.position_m).north_deg;
    heading_deg -= 360.0 * std::floor(heading_deg / 360.0);
    text += "<gx:angles>" + format_fixed(heading_deg, 6) + " 0 0</gx:angles>\n";
  }
  file_.write(text + "</gx:Track></Placemark>\n");
}

void KmlExport::write_place(const std::string& name, const Vec3& position_m) {
  file_.write("<Placemark><name>" + xml_text(name) +
              "</name><Point><altitudeMode>relativeToGround</altitudeMode><coordinates>" +
              coordinates(position_m, position_m.z, ',') + "</coordinates></Point></Placemark>\n");
}

/// Nine decimals of a degree are a tenth of a millimetre.
std::string KmlExport::coordinates(const Vec3& position_m, double height_m, char separator) const {
  const GeoPlace there = place(position_m);
  return format_fixed(there.lon_deg, 9) + separator + format_fixed(there.lat_deg, 9) + separator +
         format_fixed(height_m, 3);
}

std::string KmlExport::instant_text(double time_s) const {
  return calendar_text(start_us_ + std::llround(time_s * 1e6));
}

double KmlExport::share_of(double power_dbm) const {
  const auto& [low, high] = settings_.range_dbm;
  return std::clamp((power_dbm - low) / (high - low), 0.0, 1.0);
}

/// The lines of the last frame last as long as those of the one before; of the only one a second.
void KmlExport::finish() {
  if (!times_s_.empty()) {
    const double last_s = times_s_.back();
    write_lines(times_s_.size() < 2 ? last_s + 1.0 : last_s + (last_s - times_s_.front()));
  }
  for (const auto& [name, points] : tracks_) write_track(name, points);
  file_.write("</Document>\n</kml>\n");
  file_.close();
}

}  // namespace dcem::io
