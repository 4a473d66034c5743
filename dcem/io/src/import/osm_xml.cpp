#include <algorithm>
#include <array>
#include <cmath>

#include "dcem/io/src/import/osm_data.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/xml_reader.hpp"

namespace dcem::io {

namespace {

class OsmXmlReader : private XmlHandler {
 public:
  explicit OsmXmlReader(const std::filesystem::path& file) : reader_(file, "expected OpenStreetMap data", *this) {}

  OsmData read() {
    reader_.read_on();
    return std::move(data_);
  }

 private:
  enum class Open { nothing, node, way, relation };

  void start_element(std::string_view name, const XmlAttributes& attributes) override {
    if (!has_root_ && name != "osm") reader_.fail("found <" + printable(name) + ">; expected <osm>");
    has_root_ = true;
    if (name == "node") {
      read_node(attributes);
      open_ = Open::node;
    } else if (name == "way") {
      way_ = {integer(attributes, "way", "id"), {}, {}};
      open_ = Open::way;
    } else if (name == "relation") {
      relation_ = {integer(attributes, "relation", "id"), {}, {}};
      open_ = Open::relation;
    } else if (name == "nd" && open_ == Open::way) {
      way_.nodes.push_back(integer(attributes, "nd", "ref"));
    } else if (name == "member" && open_ == Open::relation) {
      read_member(attributes);
    } else if (name == "tag") {
      read_tag(attributes);
    }
  }

  void end_element(std::string_view name) override {
    // Ways without tags may be parts of rings.
    if (name == "way") data_.ways.push_back(std::move(way_));
    if (name == "relation" && !relation_.members.empty()) data_.relations.push_back(std::move(relation_));
    if (name == "node" || name == "way" || name == "relation") open_ = Open::nothing;
  }

  std::int64_t integer(const XmlAttributes& attributes, const std::string& element, const char* name) const {
    const auto text = attributes.find(name);
    const auto number = text ? parse_integer(*text) : std::nullopt;
    if (number) return *number;
    reader_.fail(element + ": " + name + ": " + (text ? "found " + in_quotes(*text) : "missing") +
                 "; expected a whole number");
  }

  double degrees(const XmlAttributes& attributes, const char* name, double most_deg) const {
    const auto text = attributes.find(name);
    const auto number = text ? parse_number(*text) : std::nullopt;
    if (number && std::abs(*number) <= most_deg) return *number;
    reader_.fail(std::string("node: ") + name + ": " + (text ? "found " + in_quotes(*text) : "missing") +
                 "; expected degrees from -" + number_text(most_deg) + " to " + number_text(most_deg));
  }

  void read_node(const XmlAttributes& attributes) {
    if (attributes.find("visible").value_or("true") == "false") return;
    const std::int64_t id = integer(attributes, "node", "id");
    data_.nodes[id] = {degrees(attributes, "lat", 84.0), degrees(attributes, "lon", 180.0)};
  }

  void read_member(const XmlAttributes& attributes) {
    if (attributes.find("type").value_or("") != "way") return;
    relation_.members.push_back(
        {integer(attributes, "member", "ref"), std::string(attributes.find("role").value_or(""))});
  }

  void read_tag(const XmlAttributes& attributes) {
    if (open_ != Open::way && open_ != Open::relation) return;
    const std::string key(attributes.find("k").value_or(""));
    if (!is_kept_key(key)) return;
    (open_ == Open::way ? way_.tags : relation_.tags)[key] = attributes.find("v").value_or("");
  }

  XmlReader reader_;
  OsmData data_;
  OsmWay way_;
  OsmRelation relation_;
  Open open_ = Open::nothing;
  bool has_root_ = false;
};

bool has(const OsmTags& tags, const char* key, std::string_view value) {
  const auto found = tags.find(key);
  return found != tags.end() && found->second == value;
}

}  // namespace

bool is_kept_key(const std::string& key) {
  static constexpr std::array<std::string_view, 14> kept{
      "building",           "building:part", "height",  "building:levels", "roof:levels", "building:material",
      "roof:material",      "min_height",    "natural", "landuse",         "type",        "location",
      "building:min_level", "layer"};
  return std::find(kept.begin(), kept.end(), key) != kept.end();
}

bool is_kept(const OsmTags& tags) {
  const bool is_house = (tags.contains("building") && !has(tags, "building", "no")) ||
                        (tags.contains("building:part") && !has(tags, "building:part", "no"));
  return is_house || has(tags, "natural", "wood") || has(tags, "landuse", "forest");
}

OsmData read_osm_xml(const std::filesystem::path& file) {
  return OsmXmlReader(file).read();
}

}  // namespace dcem::io
