#include "dcem/io/result_writer.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "dcem/core/units.hpp"
#include "dcem/io/src/number_text.hpp"
#include "dcem/paths/path_id.hpp"

namespace dcem::io {
namespace {

constexpr std::size_t sheet_bytes = std::size_t{1} << 20;

// Bytes that are not UTF-8 (old OBJ files) become the replacement character: JSON has no way to hold them.
std::string json_string(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// JSON written straight into text, which is several times faster than through a document in memory. The comma before
// an element is due unless the element is the first in its bracket or follows its key.
class JsonLine {
 public:
  explicit JsonLine(std::string& text) : text_(text) {}

  JsonLine& open(char bracket) {
    separate();
    text_.push_back(bracket);
    return *this;
  }
  JsonLine& close(char bracket) {
    text_.push_back(bracket);
    return *this;
  }
  JsonLine& key(std::string_view name) {
    separate();
    text_.append("\"").append(name).append("\":");
    return *this;
  }
  JsonLine& number(double value) {
    separate();
    if (!append_number(text_, value)) text_ += "null";
    return *this;
  }
  JsonLine& prepared(std::string_view element) {
    separate();
    text_ += element;
    return *this;
  }
  JsonLine& complex(const Complex& value) { return open('[').number(value.real()).number(value.imag()).close(']'); }
  JsonLine& point(const Vec3& value) { return open('[').number(value.x).number(value.y).number(value.z).close(']'); }

 private:
  void separate() {
    const char last = text_.empty() ? '\n' : text_.back();
    if (last != '\n' && last != '[' && last != '{' && last != ':') text_.push_back(',');
  }

  std::string& text_;
};

void append_transfer(JsonLine& line, const ComplexMatrix2& transfer) {
  line.key("transfer").open('[');
  for (std::size_t receive = 0; receive < 2; ++receive) {
    line.open('[').complex(transfer(receive, 0)).complex(transfer(receive, 1)).close(']');
  }
  line.close(']');
}

void append_channel(JsonLine& line, const ChannelMatrix& channel) {
  line.key("channel").open('[');
  for (std::size_t receive = 0; receive < channel.rows(); ++receive) {
    line.open('[');
    for (std::size_t transmit = 0; transmit < channel.columns(); ++transmit) line.complex(channel(receive, transmit));
    line.close(']');
  }
  line.close(']');
}

void append_direction(JsonLine& line, std::string_view name, const Direction& direction) {
  line.key(name).open('{').key("azimuth_rad").number(direction.azimuth_rad);
  line.key("zenith_rad").number(direction.zenith_rad).close('}');
}

// Only paths with a diffraction say whether a wedge hides one side of it from the other.
void append_shadow(JsonLine& line, const std::vector<Interaction>& interactions) {
  const auto diffracts = [](const Interaction& at) { return at.kind == InteractionKind::diffraction; };
  if (std::none_of(interactions.begin(), interactions.end(), diffracts)) return;
  const bool in_shadow =
      std::any_of(interactions.begin(), interactions.end(), [](const Interaction& at) { return at.in_shadow; });
  line.key("in_shadow").prepared(in_shadow ? "true" : "false");
}

AtomicFile* open_sheet(OutputFolder& folder, bool wanted, const char* name) {
  return wanted ? &folder.open(name) : nullptr;
}

}  // namespace

void ResultWriter::Sheet::flush(std::size_t limit) {
  if (file == nullptr || text.size() < limit) return;
  file->write(text);
  text.clear();
}

ResultWriter::ResultWriter(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                           Discovery discovery, const OutputSettings& output)
    : scene_(scene), output_(output), found_by_(discovery == Discovery::exact ? "\"exact\"" : "\"sampled\"") {
  paths_.file = open_sheet(folder, output.paths, "paths.jsonl");
  links_.file = open_sheet(folder, output.links, "links.csv");
  profile_.file = open_sheet(folder, output.pdp, "pdp.csv");
  links_.text = std::string(links_csv_header) + '\n';
  profile_.text = std::string(pdp_csv_header) + '\n';
  for (const Device& device : scene.transmitters()) {
    json_transmitters_.push_back(json_string(device.id));
    csv_transmitters_.push_back(csv_field(device.id));
    power_dbm_.push_back(device.power_dbm);
  }
  for (const Device& device : receivers) {
    json_receivers_.push_back(json_string(device.id));
    csv_receivers_.push_back(csv_field(device.id));
  }
  for (const Body& body : scene.bodies()) json_bodies_.push_back(json_string(body.id));
  for (const Material& material : scene.materials()) json_materials_.push_back(json_string(material.name));
}

void ResultWriter::write(const FrameResult& frame) {
  for (const LinkResult& link : frame.links) {
    if (output_.paths) append_paths(frame, link);
    if (output_.links) append_link(frame, link);
    if (output_.pdp) append_profile(frame, link);
    for (Sheet* sheet : {&paths_, &links_, &profile_}) sheet->flush(sheet_bytes);
  }
  for (Sheet* sheet : {&paths_, &links_, &profile_}) sheet->flush(1);
}

void ResultWriter::append_paths(const FrameResult& frame, const LinkResult& link) {
  paths_.text += "{\"frame\":";
  append_number(paths_.text, frame.index);
  JsonLine line(paths_.text);
  line.key("time_s").number(frame.time_s);
  line.key("tx").prepared(json_transmitters_[link.transmitter]);
  line.key("rx").prepared(json_receivers_[link.receiver]);
  line.key("complete").prepared(link.complete ? "true" : "false");
  line.key("paths").open('[');
  for (const PathContribution& path : link.paths) append_path(link, path);
  line.close(']').close('}').close('\n');
}

void ResultWriter::append_path(const LinkResult& link, const PathContribution& path) {
  const std::vector<Interaction>& interactions = path.path.interactions;
  const double gain_db = power_ratio_to_db(path.power_ratio);
  JsonLine line(paths_.text);
  const auto list = [&](std::string_view name, auto&& append_entry) {
    line.key(name).open('[');
    for (const Interaction& interaction : interactions) append_entry(interaction);
    line.close(']');
  };
  line.open('{').key("id").prepared(json_string(path_id(scene_, path.path)));
  line.key("kinds").prepared('"' + kinds(path.path) + '"');
  list("points_m", [&](const Interaction& at) { line.point(at.point_m); });
  list("objects", [&](const Interaction& at) { line.prepared(object_json(scene_.facet(at.facet).body)); });
  list("materials",
       [&](const Interaction& at) { line.prepared(json_materials_[scene_.facet(at.facet).material.value]); });
  line.key("length_m").number(path.path.length_m).key("delay_s").number(path.delay_s);
  line.key("found_by").prepared(found_by_);
  append_transfer(line, path.transfer);
  line.key("amplitude");
  path.has_amplitude ? line.complex(path.amplitude) : line.prepared("null");
  if (!path.channel.empty()) append_channel(line, path.channel);
  line.key("path_gain_db").number(gain_db);
  line.key("received_power_dbm").number(power_dbm_[link.transmitter] + gain_db);
  append_direction(line, "departure", path.departure);
  append_direction(line, "arrival", path.arrival);
  line.key("doppler_hz").number(path.doppler_hz);
  append_shadow(line, interactions);
  line.close('}');
}

std::string ResultWriter::object_json(BodyId id) const {
  return scene_.body(id).is_place ? json_string(scene_.body_name(id)) : json_bodies_[id.value];
}

void ResultWriter::append_link(const FrameResult& frame, const LinkResult& link) {
  const LinkStatistics& values = link.statistics;
  CsvLine line(links_.text);
  line.count(frame.index).number(frame.time_s);
  line.prepared(csv_transmitters_[link.transmitter]).prepared(csv_receivers_[link.receiver]);
  line.flag(values.line_of_sight).count(values.path_count).flag(link.complete);
  line.empty();  // valid_until_m: nothing is proved about other frames
  line.number(values.power_dbm).number(values.power_incoherent_dbm).number(values.power_los_dbm);
  line.number(values.power_reflected_dbm).number(values.power_transmitted_dbm);
  line.number(values.power_diffracted_dbm).empty();  // there are no diffuse paths
  line.number(values.path_gain_db).number(values.first_delay_s).number(values.mean_delay_s);
  line.number(values.rms_delay_spread_s).number(values.k_factor_db);
  line.number(values.azimuth_spread_arrival_rad).number(values.azimuth_spread_departure_rad);
  line.number(values.mean_doppler_hz).number(values.rms_doppler_spread_hz).end();
}

void ResultWriter::append_profile(const FrameResult& frame, const LinkResult& link) {
  for (const PdpTap& tap : power_delay_profile(link.paths, output_.pdp_bin_s, output_.pdp_mode)) {
    CsvLine line(profile_.text);
    line.count(frame.index).prepared(csv_transmitters_[link.transmitter]).prepared(csv_receivers_[link.receiver]);
    line.number(tap.delay_s).number(power_dbm_[link.transmitter] + power_ratio_to_db(tap.power_ratio)).end();
  }
}

}  // namespace dcem::io
