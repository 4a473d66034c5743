#include "dcem/io/src/results/path_collector.hpp"

#include <algorithm>
#include <limits>

#include "dcem/io/src/exchange/mat_writer.hpp"
#include "dcem/io/src/results/array_parts.hpp"
#include "dcem/io/src/results/link_entries.hpp"

namespace dcem::io {
namespace {

// Of one place for a path: valid, a, transfer, tau, four angles, doppler; and of one for an interaction of it.
constexpr double bytes_per_path = 1 + 16 + 64 + 6 * 8, bytes_per_interaction = 4 + 24;

std::uint32_t code_of(InteractionKind kind) {
  switch (kind) {
    case InteractionKind::reflection:
      return 1;
    case InteractionKind::scattering:
      return 2;
    case InteractionKind::transmission:
      return 4;
    case InteractionKind::diffraction:
      return 8;
  }
  return 0;
}

std::complex<double> amplitude_of(const PathContribution& path) {
  constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
  return path.has_amplitude ? path.amplitude : std::complex<double>(undefined, undefined);
}

}  // namespace

PathCollector::PathCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                             const ResultFacts& facts, const OutputSettings& output)
    : npz_(output.npz ? &folder.open("paths.npz") : nullptr),
      mat_(output.exchange.mat ? &folder.open("paths.mat") : nullptr),
      facts_(facts),
      transmitters_(ids_of(scene.transmitters())),
      receivers_(ids_of(receivers)) {
  check_memory();
}

void PathCollector::check_memory() const {
  const double links = static_cast<double>(std::max(facts_.frames, times_s_.size())) *
                       static_cast<double>(receivers_.size()) * static_cast<double>(transmitters_.size());
  const double bytes = links * static_cast<double>(longest_list_) *
                       (bytes_per_path + bytes_per_interaction * static_cast<double>(most_interactions_));
  const std::string remedy = "fewer frames, receivers or paths";
  require_array_memory(std::string(npz_ != nullptr ? "output.npz" : "output.mat") + ": the paths of this run", bytes,
                       " as arrays", facts_.memory_limit_bytes, remedy);
  if (mat_ == nullptr) return;
  const double largest = std::max(64.0, 24.0 * static_cast<double>(most_interactions_));  // transfer, or vertices
  const double array_bytes = links * static_cast<double>(longest_list_) * largest;
  if (array_bytes <= most_mat_array_bytes) return;
  throw std::invalid_argument("output.mat: one array of this run's paths needs " + memory_text(array_bytes) +
                              "; expected at most " + memory_text(most_mat_array_bytes) +
                              ", which is all that a MAT file can hold (" + remedy + ", or output.npz)");
}

void PathCollector::add(const FrameResult& frame) {
  times_s_.push_back(frame.time_s);
  for (const LinkResult& link : frame.links) add_link(link);
}

void PathCollector::add_link(const LinkResult& link) {
  const std::vector<LinkEntry> entries = link_entries(link, facts_.diffuse_paths);
  longest_list_ = std::max(longest_list_, entries.size());
  for (const LinkEntry& entry : entries) {
    most_interactions_ = std::max(most_interactions_, entry.geometry().interactions.size());
  }
  check_memory();  // before anything is kept of the link
  const std::size_t first_link = links() - receivers_.size() * transmitters_.size();
  const std::size_t place = first_link + link.receiver * transmitters_.size() + link.transmitter;
  for (std::size_t slot = 0; slot < entries.size(); ++slot) {
    const PathContribution* path = entries[slot].path;
    const std::vector<Interaction>& interactions = entries[slot].geometry().interactions;
    // A tile has power and no field.
    const PowerSample sample = path != nullptr ? power_sample(*path) : entries[slot].tile->sample;
    rows_.push_back({place, slot, touches_.size(), interactions.size(), path != nullptr ? amplitude_of(*path) : 0.0,
                     path != nullptr ? path->transfer : ComplexMatrix2{}, sample.delay_s, sample.doppler_hz,
                     sample.departure, sample.arrival});
    for (const Interaction& at : interactions) touches_.push_back({code_of(at.kind), at.point_m});
  }
}

template <typename Value, typename Pick>
std::vector<Value> PathCollector::dense(Value filler, Pick&& value) const {
  std::vector<Value> values(links() * longest_list_, filler);
  for (const Row& row : rows_) values[row.link * longest_list_ + row.slot] = value(row);
  return values;
}

NpzWriter::Shape PathCollector::shape(bool by_interaction, std::initializer_list<std::size_t> more) const {
  NpzWriter::Shape shape{times_s_.size(), receivers_.size(), transmitters_.size(), longest_list_};
  if (by_interaction) shape.insert(shape.begin(), most_interactions_);
  shape.insert(shape.end(), more);
  return shape;
}

template <typename Archive>
void PathCollector::add_fields(Archive& archive) const {
  using Complex64 = std::complex<double>;
  archive.add("valid", shape(false), dense<bool>(false, [](const Row&) { return true; }));
  const auto amplitudes = dense<Complex64>(0.0, [](const Row& row) { return row.amplitude; });
  archive.add("a", shape(false), std::span<const Complex64>(amplitudes));
  std::vector<Complex64> transfers(links() * longest_list_ * 4);
  for (const Row& row : rows_) {
    const std::size_t first = (row.link * longest_list_ + row.slot) * 4;
    for (std::size_t entry = 0; entry < 4; ++entry) transfers[first + entry] = row.transfer(entry / 2, entry % 2);
  }
  archive.add("transfer", shape(false, {2, 2}), std::span<const Complex64>(transfers));
}

template <typename Archive>
void PathCollector::add_angles(Archive& archive) const {
  const auto add = [&](const char* name, double filler, auto&& value) {
    const std::vector<double> values = dense<double>(filler, value);
    archive.add(name, shape(false), std::span<const double>(values));
  };
  add("tau", -1.0, [](const Row& row) { return row.delay_s; });
  add("theta_t", 0.0, [](const Row& row) { return row.departure.zenith_rad; });
  add("phi_t", 0.0, [](const Row& row) { return row.departure.azimuth_rad; });
  add("theta_r", 0.0, [](const Row& row) { return row.arrival.zenith_rad; });
  add("phi_r", 0.0, [](const Row& row) { return row.arrival.azimuth_rad; });
  add("doppler", 0.0, [](const Row& row) { return row.doppler_hz; });
}

template <typename Archive>
void PathCollector::add_interactions(Archive& archive) const {
  const std::size_t places = links() * longest_list_;
  std::vector<std::uint32_t> codes(most_interactions_ * places, 0);
  std::vector<double> vertices(codes.size() * 3, 0.0);
  for (const Row& row : rows_) {
    for (std::size_t depth = 0; depth < row.touches; ++depth) {
      const Touch& touch = touches_[row.first_touch + depth];
      const std::size_t place = depth * places + row.link * longest_list_ + row.slot;
      codes[place] = touch.code;
      for (int axis = 0; axis < 3; ++axis) vertices[place * 3 + static_cast<std::size_t>(axis)] = touch.point_m[axis];
    }
  }
  archive.add("interactions", shape(true), std::span<const std::uint32_t>(codes));
  archive.add("vertices", shape(true, {3}), std::span<const double>(vertices));
}

template <typename Archive>
void PathCollector::add_all(Archive& archive) const {
  add_fields(archive);
  add_angles(archive);
  add_interactions(archive);
  archive.add("time_s", {times_s_.size()}, std::span<const double>(times_s_));
  archive.add("tx_id", {transmitters_.size()}, std::span<const std::string>(transmitters_));
  archive.add("rx_id", {receivers_.size()}, std::span<const std::string>(receivers_));
  archive.add("frequency_hz", {}, std::span<const double>(&facts_.frequency_hz, 1));
}

void PathCollector::write() {
  if (npz_ != nullptr) {
    NpzWriter npz(NpzCompression::deflate);  // lists are padded to the longest one
    add_all(npz);
    npz.write(*npz_);
  }
  if (mat_ != nullptr) {
    MatWriter mat(*mat_);
    add_all(mat);
    mat.finish();
  }
}

}  // namespace dcem::io
