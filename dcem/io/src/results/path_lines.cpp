#include "dcem/io/src/results/path_lines.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "dcem/core/units.hpp"
#include "dcem/io/src/results/link_entries.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/paths/path_id.hpp"
#include "dcem/sim/discovery.hpp"

namespace dcem::io {
namespace {

// Bytes that are not UTF-8 (old OBJ files) become the replacement character: JSON has no way to hold them. Most names
// need nothing of this, and each path has some.
std::string json_string(const std::string& text) {
  const auto is_plain = [](char letter) { return letter >= ' ' && letter <= '~' && letter != '"' && letter != '\\'; };
  if (std::all_of(text.begin(), text.end(), is_plain)) return '"' + text + '"';
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

}  // namespace

std::string tile_id(const Scene& scene, const DiffuseContribution& tile) {
  // Many tiles of one facet have the same surfaces; which part of it they are tells them apart.
  const BodyId body = scene.facet(scene.facet_of_triangle(tile.triangle)).body;
  const std::uint32_t number = tile.triangle - scene.triangle_range(body).first;
  return path_id(scene, tile.path) + "#" + std::to_string(number) + "." + std::to_string(tile.place);
}

PathLines::PathLines(const Scene& scene, std::span<const Device> receivers, const ResultFacts& facts,
                     std::optional<std::size_t> top)
    : scene_(scene), facts_(facts), top_(top) {
  for (const Device& device : scene.transmitters()) {
    transmitters_.push_back(json_string(device.id));
    power_dbm_.push_back(device.power_dbm);
  }
  for (const Device& device : receivers) receivers_.push_back(json_string(device.id));
  for (const Body& body : scene.bodies()) bodies_.push_back(json_string(body.id));
  for (const Material& material : scene.materials()) materials_.push_back(json_string(material.name));
}

void PathLines::append(std::string& text, const FrameResult& frame, const LinkResult& link) const {
  text += "{\"frame\":";
  append_number(text, frame.index);
  JsonLine line(text);
  line.key("time_s").number(frame.time_s);
  line.key("tx").prepared(transmitters_[link.transmitter]);
  line.key("rx").prepared(receivers_[link.receiver]);
  line.key("complete").prepared(link.complete ? "true" : "false");
  std::vector<LinkEntry> entries = link_entries(link, facts_.diffuse_paths);
  if (top_) {
    line.key("paths_in_all");
    append_number(text, entries.size());
    keep_strongest(entries, *top_);
  }
  line.key("paths").open('[');
  for (const LinkEntry& entry : entries) {
    entry.path != nullptr ? append_path(text, link, *entry.path) : append_tile(text, link, *entry.tile);
  }
  line.close(']').close('}').close('\n');
}

void PathLines::append_geometry(std::string& text, const Path& path, const std::string& id, double delay_s,
                                std::string_view found_by) const {
  JsonLine line(text);
  const auto list = [&](std::string_view name, auto&& append_entry) {
    line.key(name).open('[');
    for (const Interaction& interaction : path.interactions) append_entry(interaction);
    line.close(']');
  };
  line.open('{').key("id").prepared(json_string(id));
  line.key("kinds").prepared('"' + kinds(path) + '"');
  list("points_m", [&](const Interaction& at) { line.point(at.point_m); });
  list("objects", [&](const Interaction& at) { line.prepared(object_json(scene_.facet(at.facet).body)); });
  list("materials", [&](const Interaction& at) { line.prepared(materials_[scene_.facet(at.facet).material.value]); });
  line.key("length_m").number(path.length_m).key("delay_s").number(delay_s);
  line.key("found_by").prepared(found_by);
}

void PathLines::append_power(std::string& text, const LinkResult& link, const PowerSample& sample) const {
  const double gain_db = power_ratio_to_db(sample.power_ratio);
  JsonLine line(text);
  line.key("path_gain_db").number(gain_db);
  line.key("received_power_dbm").number(power_dbm_[link.transmitter] + gain_db);
  append_direction(line, "departure", sample.departure);
  append_direction(line, "arrival", sample.arrival);
  line.key("doppler_hz").number(sample.doppler_hz);
}

void PathLines::append_path(std::string& text, const LinkResult& link, const PathContribution& path) const {
  const bool is_exact = is_found_exactly(path.path, facts_.exact_interactions, facts_.discovery);
  append_geometry(text, path.path, path_id(scene_, path.path), path.delay_s, is_exact ? "\"exact\"" : "\"sampled\"");
  JsonLine line(text);
  append_transfer(line, path.transfer);
  line.key("amplitude");
  path.has_amplitude ? line.complex(path.amplitude) : line.prepared("null");
  if (!path.channel.empty()) append_channel(line, path.channel);
  append_power(text, link, power_sample(path));
  append_shadow(line, path.path.interactions);
  line.close('}');
}

void PathLines::append_tile(std::string& text, const LinkResult& link, const DiffuseContribution& tile) const {
  append_geometry(text, tile.path, tile_id(scene_, tile), tile.sample.delay_s, "\"tiles\"");
  JsonLine line(text);
  line.key("transfer").prepared("null").key("amplitude").prepared("null");
  append_power(text, link, tile.sample);
  line.close('}');
}

std::string PathLines::object_json(BodyId id) const {
  return scene_.body(id).is_slot ? json_string(scene_.body_name(id)) : bodies_[id.value];
}

}  // namespace dcem::io
