#include "dcem/io/src/import/sumo_files.hpp"

#include <cmath>

#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/xml_reader.hpp"

namespace dcem::io {

namespace {

/// Numbers with commas between: "x,y" or "x,y,z". Nothing where there is anything else.
std::optional<std::vector<double>> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t begin = 0, end = 0; end != std::string_view::npos; begin = end + 1) {
    end = text.find(',', begin);
    const std::optional<double> number = parse_number(text.substr(begin, end == text.npos ? end : end - begin));
    if (!number || std::abs(*number) > 1e9) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

class SumoFileReader : private XmlHandler {
 public:
  SumoFileReader(const std::filesystem::path& file, const std::string& expectation)
      : reader_(file, expectation, *this) {}

  SumoContents read() {
    reader_.read_on();
    return std::move(contents_);
  }

 private:
  void start_element(std::string_view name, const XmlAttributes& attributes) override {
    if (contents_.root.empty()) contents_.root = name;
    if (name == "location") read_location(attributes);
    if (name == "poly" || name == "polygon") read_polygon(attributes);
    if (name == "param" && in_polygon_) read_parameter(attributes);
    if (name == "edge") is_street_ = attributes.find("function").value_or("normal") == "normal";
    if (name == "lane" && is_street_) read_lane(attributes);
    if (name == "vType") contents_.vehicle_types.emplace(attributes.find("id").value_or(""));
    if (name == "poi") ++contents_.points_of_interest;
  }

  void end_element(std::string_view name) override {
    if (name == "poly" || name == "polygon") in_polygon_ = false;
  }

  void read_location(const XmlAttributes& attributes) {
    SumoLocation location;
    const std::vector<double> offset = numbers(attributes, "location", "netOffset", 2);
    const std::vector<double> box = numbers(attributes, "location", "convBoundary", 4);
    location.net_offset_m = {offset[0], offset[1]};
    location.low_m = {box[0], box[1]};
    location.high_m = {box[2], box[3]};
    location.projection = attributes.find("projParameter").value_or("!");
    if (!contents_.location) contents_.location = location;
  }

  void read_polygon(const XmlAttributes& attributes) {
    SumoPolygon polygon;
    polygon.id = printable(attributes.find("id").value_or(""));
    if (polygon.id.empty()) reader_.fail("poly: id: missing; expected the polygon's name");
    polygon.type = printable(attributes.find("type").value_or(""));
    const std::string_view geo = attributes.find("geo").value_or("0");
    polygon.is_geo = geo == "1" || geo == "true";
    polygon.shape = shape(attributes, "poly '" + polygon.id + "'");
    contents_.polygons.push_back(std::move(polygon));
    in_polygon_ = true;
  }

  void read_parameter(const XmlAttributes& attributes) {
    const auto key = attributes.find("key"), value = attributes.find("value");
    if (key && value) contents_.polygons.back().parameters.emplace(*key, *value);
  }

  void read_lane(const XmlAttributes& attributes) {
    Ring line = shape(attributes, "lane '" + printable(attributes.find("id").value_or("")) + "'");
    if (line.size() > 1) contents_.lanes.push_back(std::move(line));
  }

  Ring shape(const XmlAttributes& attributes, const std::string& element) const {
    const auto text = attributes.find("shape");
    if (!text) reader_.fail(element + ": shape: missing; expected corners as x,y");
    Ring corners;
    std::string_view rest = *text;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const auto corner = numbers_of(word);
      if (!corner || corner->size() < 2 || corner->size() > 3) {
        reader_.fail(element + ": shape: found " + in_quotes(word) + "; expected corners as x,y within 1e9 m");
      }
      corners.emplace_back((*corner)[0], (*corner)[1]);
    }
    return corners;
  }

  std::vector<double> numbers(const XmlAttributes& attributes, const std::string& element, const char* name,
                              std::size_t count) const {
    const auto text = attributes.find(name);
    const auto found = text ? numbers_of(*text) : std::nullopt;
    if (found && found->size() == count) return *found;
    reader_.fail(element + ": " + name + ": " + (text ? "found " + in_quotes(*text) : "missing") + "; expected " +
                 std::to_string(count) + " numbers with commas between");
  }

  XmlReader reader_;
  SumoContents contents_;
  bool in_polygon_ = false, is_street_ = false;
};

class SumoConfigurationReader : private XmlHandler {
 public:
  explicit SumoConfigurationReader(const std::filesystem::path& file)
      : folder_(file.parent_path()), reader_(file, "expected a SUMO configuration", *this) {}

  SumoConfiguration read() {
    reader_.read_on();
    return std::move(found_);
  }

 private:
  void start_element(std::string_view name, const XmlAttributes& attributes) override {
    const std::string_view value = attributes.find("value").value_or("");
    if (name == "net-file" || name == "net" || name == "n") add(value, found_.networks);
    if (name == "route-files" || name == "route" || name == "r") add(value, found_.routes);
    if (name == "additional-files" || name == "additional" || name == "a") add(value, found_.additional);
    if (name == "fcd-output") add(value, found_.traces);
  }

  void end_element(std::string_view) override {}

  /// Names with commas or blanks between.
  void add(std::string_view value, std::vector<std::filesystem::path>& files) const {
    std::string name;
    for (const char letter : std::string(value) + ',') {
      if (letter != ',' && letter != ' ' && letter != ';') {
        name += letter;
      } else if (!name.empty()) {
        files.push_back(folder_ / name);
        name.clear();
      }
    }
  }

  std::filesystem::path folder_;
  XmlReader reader_;
  SumoConfiguration found_;
};

}  // namespace

std::optional<UtmZone> SumoLocation::zone() const {
  if (projection.find("+proj=utm") == std::string::npos) return std::nullopt;
  const std::size_t place = projection.find("+zone=");
  if (place == std::string::npos) return std::nullopt;
  std::string_view rest = std::string_view(projection).substr(place + 6);
  const std::optional<long long> number = parse_integer(take_word(rest));
  if (!number || *number < 1 || *number > 60) return std::nullopt;
  return UtmZone{static_cast<int>(*number), projection.find("+south") == std::string::npos};
}

SumoContents read_sumo_file(const std::filesystem::path& file, const std::string& expectation) {
  return SumoFileReader(file, expectation).read();
}

SumoConfiguration read_sumo_configuration(const std::filesystem::path& file) {
  return SumoConfigurationReader(file).read();
}

}  // namespace dcem::io
