#include "dcem/io/src/exchange/column_export.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "dcem/core/units.hpp"
#include "dcem/io/src/results/array_parts.hpp"
#include "dcem/io/src/results/link_entries.hpp"

namespace dcem::io {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// A path as its columns are taken from it.
struct Row {
  const LinkEntry& entry;
  const PowerSample& sample;
  double transmit_power_dbm = 0.0;

  double gain_db() const { return power_ratio_to_db(entry.power_ratio()); }
  std::complex<double> amplitude() const {
    if (entry.path == nullptr || !entry.path->has_amplitude) return {undefined, undefined};
    return entry.path->amplitude;
  }
};

/// 1 reflection, 2 diffuse, 4 transmission, 8 diffraction, each that occurs, added.
double kinds_of(const Path& path) {
  unsigned kinds = 0;
  for (const Interaction& at : path.interactions) {
    if (at.kind == InteractionKind::reflection) kinds |= 1u;
    if (at.kind == InteractionKind::scattering) kinds |= 2u;
    if (at.kind == InteractionKind::transmission) kinds |= 4u;
    if (at.kind == InteractionKind::diffraction) kinds |= 8u;
  }
  return kinds;
}

struct ColumnKind {
  std::string_view name;
  bool is_usual;
  bool is_count;  // one byte, whatever the precision
  double (*value)(const Row&);
};

constexpr std::array<ColumnKind, 13> column_kinds{{
    {"delay_s", true, false, [](const Row& row) { return row.sample.delay_s; }},
    {"amplitude_re", true, false, [](const Row& row) { return row.amplitude().real(); }},
    {"amplitude_im", true, false, [](const Row& row) { return row.amplitude().imag(); }},
    {"doppler_hz", true, false, [](const Row& row) { return row.sample.doppler_hz; }},
    {"departure_azimuth_rad", true, false, [](const Row& row) { return row.sample.departure.azimuth_rad; }},
    {"departure_zenith_rad", true, false, [](const Row& row) { return row.sample.departure.zenith_rad; }},
    {"arrival_azimuth_rad", true, false, [](const Row& row) { return row.sample.arrival.azimuth_rad; }},
    {"arrival_zenith_rad", true, false, [](const Row& row) { return row.sample.arrival.zenith_rad; }},
    {"path_gain_db", false, false, [](const Row& row) { return row.gain_db(); }},
    {"received_power_dbm", false, false, [](const Row& row) { return row.transmit_power_dbm + row.gain_db(); }},
    {"length_m", false, false, [](const Row& row) { return row.entry.geometry().length_m; }},
    {"kinds", false, true, [](const Row& row) { return kinds_of(row.entry.geometry()); }},
    {"interaction_count", false, true,
     [](const Row& row) { return static_cast<double>(row.entry.geometry().interactions.size()); }},
}};

}  // namespace

std::vector<std::string> path_column_names() {
  std::vector<std::string> names;
  for (const ColumnKind& kind : column_kinds) names.emplace_back(kind.name);
  return names;
}

Hdf5Export::Hdf5Export(const ExportContext& context)
    : file_(context.folder.open("paths.h5")), columns_(file_), diffuse_paths_(context.facts.diffuse_paths) {
  for (const Device& device : context.scene.transmitters()) power_dbm_.push_back(device.power_dbm);
  open_columns(context);
}

void Hdf5Export::open_columns(const ExportContext& context) {
  columns_.add_texts("tx_id", ids_of(context.scene.transmitters()));
  columns_.add_texts("rx_id", ids_of(context.receivers));
  for (const char* group : {"paths", "links", "frames"}) columns_.add_group(group);
  const Hdf5Settings& settings = context.output.exchange.hdf5_settings;
  const std::vector<std::string>& wanted = settings.columns;
  const ColumnType real = settings.single ? ColumnType::float32 : ColumnType::float64;
  for (std::size_t kind = 0; kind < column_kinds.size(); ++kind) {
    const std::string name(column_kinds[kind].name);
    const bool is_named = std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    if (wanted.empty() ? !column_kinds[kind].is_usual : !is_named) continue;
    const ColumnType type = column_kinds[kind].is_count ? ColumnType::uint8 : real;
    paths_.push_back({columns_.open_column("paths/" + name, type), kind});
  }
  link_frame_.number = columns_.open_column("links/frame", ColumnType::uint32);
  link_tx_.number = columns_.open_column("links/tx", ColumnType::uint32);
  link_rx_.number = columns_.open_column("links/rx", ColumnType::uint32);
  link_first_.number = columns_.open_column("links/first_path", ColumnType::uint64);
  link_count_.number = columns_.open_column("links/path_count", ColumnType::uint32);
  frame_index_.number = columns_.open_column("frames/frame", ColumnType::uint32);
  frame_time_.number = columns_.open_column("frames/time_s", ColumnType::float64);
}

void Hdf5Export::add(const FrameResult& frame, const Frame&) {
  frame_index_.values.push_back(frame.index);
  frame_time_.values.push_back(frame.time_s);
  for (const LinkResult& link : frame.links) add_link(frame.index, link);
  constexpr std::size_t rows_at_a_time = 1u << 16;
  hand_over(rows_at_a_time);
}

void Hdf5Export::add_link(std::size_t frame, const LinkResult& link) {
  const std::vector<LinkEntry> entries = link_entries(link, diffuse_paths_);
  for (const LinkEntry& entry : entries) {
    const PowerSample sample = entry.path != nullptr ? power_sample(*entry.path) : entry.tile->sample;
    const Row row{entry, sample, power_dbm_[link.transmitter]};
    for (NumberColumn& column : paths_) column.values.push_back(column_kinds[column.kind].value(row));
  }
  link_frame_.values.push_back(frame);
  link_tx_.values.push_back(link.transmitter);
  link_rx_.values.push_back(link.receiver);
  link_first_.values.push_back(rows_);
  link_count_.values.push_back(entries.size());
  rows_ += entries.size();
  waiting_ += entries.size() + 1;
}

/// Where as many rows are waiting: writing a few at a time is slow.
void Hdf5Export::hand_over(std::size_t least_rows) {
  if (waiting_ < least_rows) return;
  const auto hand = [&](auto& column) {
    using Value = typename std::decay_t<decltype(column.values)>::value_type;
    columns_.append(column.number, std::span<const Value>(column.values));
    column.values.clear();
  };
  for (NumberColumn& column : paths_) hand(column);
  for (CountColumn* column : {&link_frame_, &link_tx_, &link_rx_, &link_first_, &link_count_, &frame_index_}) {
    hand(*column);
  }
  hand(frame_time_);
  waiting_ = 0;
}

void Hdf5Export::finish() {
  hand_over(0);
  columns_.close();
}

}  // namespace dcem::io
