#include "dcem/io/src/exchange/qd_export.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_map>

#include "dcem/core/units.hpp"
#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {
namespace {

constexpr std::size_t no_file = std::numeric_limits<std::size_t>::max();
constexpr std::size_t most_qd_links = 100'000;
const std::string qd_root = "qd/";

/// What ns-3 is to add to −2π·f·delay, in [0, 2π).
double phase_beside_the_way_rad(const PathContribution& path, double frequency_hz) {
  const double periods = frequency_hz * path.delay_s;
  const double turns = std::arg(path.amplitude) / (2.0 * pi) + (periods - std::floor(periods));
  const double part = turns - std::floor(turns);
  return part < 1.0 ? 2.0 * pi * part : 0.0;  // a hair below a whole turn is rounded to one
}

double azimuth_deg(const Direction& direction) {
  const double angle_deg = radians_to_degrees(direction.azimuth_rad);
  return angle_deg < 0.0 ? angle_deg + 360.0 : angle_deg;
}

template <typename Value>
void append_line(std::string& text, const std::vector<const PathContribution*>& rays, Value&& value) {
  for (const PathContribution* ray : rays) {
    append_number(text, value(*ray));
    text += ray == rays.back() ? '\n' : ',';
  }
}

void append_point(std::string& text, const Vec3& point_m) {
  CsvLine(text).number(point_m.x).number(point_m.y).number(point_m.z).end();
}

}  // namespace

QdExport::QdExport(const ExportContext& context)
    : scene_(context.scene),
      frequency_hz_(context.facts.frequency_hz),
      files_(context.folder),
      positions_(context.folder.open(qd_root + "Output/Ns3/NodesPosition/NodesPosition.csv")),
      settings_(context.folder.open(qd_root + "Input/paraCfgCurrent.txt")) {
  require_single_ports(context, "output.qd: a ray has one amplitude in Q-D files");
  number_nodes(context);
  if (transmitter_node_.size() * receiver_node_.size() > most_qd_links) {
    throw std::invalid_argument("output.qd: " + std::to_string(transmitter_node_.size() * receiver_node_.size()) +
                                " links need as many files; expected at most " + std::to_string(most_qd_links));
  }
  open_files();
}

void QdExport::number_nodes(const ExportContext& context) {
  std::unordered_map<std::string, std::size_t> known;
  const auto number_of = [&](const Device& device) {
    const auto [place, is_new] = known.try_emplace(device.id, nodes_.size());
    if (is_new) nodes_.push_back({device});
    return place->second;
  };
  for (const Device& device : context.scene.transmitters()) transmitter_node_.push_back(number_of(device));
  for (const Device& device : context.receivers) receiver_node_.push_back(number_of(device));
}

void QdExport::open_files() {
  for (const std::size_t tx : transmitter_node_) {
    for (const std::size_t rx : receiver_node_) {
      const std::string name = "Tx" + std::to_string(tx) + "Rx" + std::to_string(rx) + ".txt";
      file_of_link_.push_back(tx == rx ? no_file : files_.open(qd_root + "Output/Ns3/QdFiles/" + name));
    }
  }
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    nodes_[node].file = files_.open(qd_root + "Input/NodePosition" + std::to_string(node) + ".dat");
  }
}

void QdExport::add(const FrameResult& frame, const Frame& instant) {
  times_s_.push_back(frame.time_s);
  const auto links = links_by_ends(frame, transmitter_node_.size(), receiver_node_.size());
  std::string block;
  for (std::size_t link = 0; link < links.size(); ++link) {
    if (file_of_link_[link] == no_file) continue;
    block.clear();
    links[link] != nullptr ? append_block(block, *links[link]) : void(block = "0\n");
    files_.append(file_of_link_[link], block);
  }
  add_positions(instant);
}

/// A node that is not there is where it was last; before it was ever there, at the origin.
void QdExport::add_positions(const Frame& instant) {
  for (Node& node : nodes_) {
    const DeviceState state = scene_.device_state(node.device, instant);
    if (state.present) node.position_m = state.position_m;
    if (state.present && !node.was_there) node.first_position_m = state.position_m;
    node.was_there = node.was_there || state.present;
    std::string line;
    append_point(line, node.position_m);
    files_.append(node.file, line);
  }
}

/// Without rays that an antenna does not hear at all: their gain is no number.
void QdExport::append_block(std::string& text, const LinkResult& link) const {
  std::vector<const PathContribution*> rays;
  for (const PathContribution& path : link.paths) {
    if (path.power_ratio > 0.0) rays.push_back(&path);
  }
  append_number(text, rays.size());
  text += '\n';
  using Ray = PathContribution;
  append_line(text, rays, [](const Ray& ray) { return ray.delay_s; });
  append_line(text, rays, [](const Ray& ray) { return power_ratio_to_db(ray.power_ratio); });
  append_line(text, rays, [&](const Ray& ray) { return phase_beside_the_way_rad(ray, frequency_hz_); });
  append_line(text, rays, [](const Ray& ray) { return radians_to_degrees(ray.departure.zenith_rad); });
  append_line(text, rays, [](const Ray& ray) { return azimuth_deg(ray.departure); });
  append_line(text, rays, [](const Ray& ray) { return radians_to_degrees(ray.arrival.zenith_rad); });
  append_line(text, rays, [](const Ray& ray) { return azimuth_deg(ray.arrival); });
}

/// ns-3 takes all steps for equally long: the duration is their number times their mean length, a second for a single
/// one.
std::string QdExport::settings_text() const {
  const double steps = static_cast<double>(times_s_.size());
  const double duration_s = times_s_.size() < 2 ? 1.0 : (times_s_.back() - times_s_.front()) / (steps - 1.0) * steps;
  std::string text = "ParameterName\tParameterValue\n";
  text += "numberOfNodes\t" + std::to_string(nodes_.size()) + "\nnumberOfTimeDivisions\t" +
          std::to_string(times_s_.size()) + "\ntotalTimeDuration\t";
  append_number(text, duration_s);
  text += "\ncarrierFrequency\t";
  append_number(text, frequency_hz_);
  return text + "\n";
}

void QdExport::finish() {
  files_.close();
  std::string text;
  for (const Node& node : nodes_) append_point(text, node.first_position_m);
  positions_.write(text);
  positions_.close();
  settings_.write(settings_text());
  settings_.close();
}

}  // namespace dcem::io
