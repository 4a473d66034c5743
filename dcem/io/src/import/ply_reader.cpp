#include "dcem/io/src/import/ply_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

enum class PlyNumber { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyWord {
  std::string_view word;
  PlyNumber number;
};
constexpr std::array<PlyWord, 16> ply_words{{{"char", PlyNumber::int8},
                                             {"int8", PlyNumber::int8},
                                             {"uchar", PlyNumber::uint8},
                                             {"uint8", PlyNumber::uint8},
                                             {"short", PlyNumber::int16},
                                             {"int16", PlyNumber::int16},
                                             {"ushort", PlyNumber::uint16},
                                             {"uint16", PlyNumber::uint16},
                                             {"int", PlyNumber::int32},
                                             {"int32", PlyNumber::int32},
                                             {"uint", PlyNumber::uint32},
                                             {"uint32", PlyNumber::uint32},
                                             {"float", PlyNumber::float32},
                                             {"float32", PlyNumber::float32},
                                             {"double", PlyNumber::float64},
                                             {"float64", PlyNumber::float64}}};

struct PlyProperty {
  std::string name;
  PlyNumber number = PlyNumber::float32;
  std::optional<PlyNumber> count;  ///< of a list
};

struct PlyElement {
  std::string name;
  long long count = 0;
  std::vector<PlyProperty> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file)
      : name_(file.string()), bytes_(read_text_file(file, "expected a PLY mesh")), rest_(bytes_) {}

  PlyMesh read() {
    read_header();
    for (const PlyElement& element : elements_) {
      for (long long index = 0; index < element.count; ++index) read_one(element, index);
    }
    check_end();
    check_indices();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    if (is_text_ || !in_body_) throw InputError(name_, line_, what);
    throw InputError(name_, what);
  }

  std::string_view next_line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail("the header breaks off; expected end_header");
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++line_;
    return trimmed(line.ends_with('\r') ? line.substr(0, line.size() - 1) : line);
  }

  void read_header() {
    if (!rest_.starts_with("ply")) throw InputError(name_, 1, "no 'ply' at the beginning; expected a PLY mesh");
    next_line();
    bool has_format = false;
    while (true) {
      std::string_view line = next_line();
      const std::string_view word = take_word(line);
      if (word == "end_header") break;
      if (word == "format") {
        read_format(take_word(line));
        has_format = true;
      } else if (word == "element") {
        read_element(line);
      } else if (word == "property") {
        read_property(line);
      } else if (word != "comment" && word != "obj_info" && !word.empty()) {
        fail("found " + in_quotes(word) + "; expected format, element, property, comment or end_header");
      }
    }
    if (!has_format) fail("no format; expected ascii or binary_little_endian");
    in_body_ = true;
    if (is_text_) ++line_;
    require_elements();
  }

  void read_format(std::string_view word) {
    if (word != "ascii" && word != "binary_little_endian") {
      fail("format " + in_quotes(word) + "; expected ascii or binary_little_endian");
    }
    is_text_ = word == "ascii";
  }

  void read_element(std::string_view rest) {
    PlyElement element{printable(take_word(rest)), 0, {}};
    const std::string_view text = take_word(rest);
    const std::optional<long long> count = parse_integer(text);
    if (!count || *count < 0) fail("element " + element.name + ": found " + in_quotes(text) + "; expected how many");
    element.count = *count;
    elements_.push_back(std::move(element));
  }

  PlyNumber number_type(std::string_view word) const {
    for (const PlyWord& known : ply_words) {
      if (known.word == word) return known.number;
    }
    fail("type " + in_quotes(word) + "; expected char, uchar, short, ushort, int, uint, float or double");
  }

  void read_property(std::string_view rest) {
    if (elements_.empty()) fail("a property before the first element; expected an element");
    PlyProperty property;
    std::string_view word = take_word(rest);
    if (word == "list") {
      property.count = number_type(take_word(rest));
      word = take_word(rest);
    }
    property.number = number_type(word);
    property.name = printable(take_word(rest));
    elements_.back().properties.push_back(std::move(property));
  }

  /// Counts that the file cannot hold are refused before anything is read.
  void require_elements() const {
    bool has_vertices = false, has_faces = false;
    for (const PlyElement& element : elements_) {
      if (element.properties.empty() && element.count > 0)
        fail("element " + element.name + " has no property; expected some");
      const long long least_bytes = is_text_ ? 2 : 1;
      if (element.count > static_cast<long long>(rest_.size() + 1) / least_bytes) {
        fail("element " + element.name + " counts " + std::to_string(element.count) +
             ", more than the file holds; expected " + "as many as follow the header");
      }
      if (element.name == "vertex") has_vertices = has_coordinates(element);
      if (element.name == "face") has_faces = has_corners(element);
    }
    if (!has_vertices) fail("no element vertex with x, y and z; expected one");
    if (!has_faces) fail("no element face with a list vertex_indices; expected one");
  }

  static bool has_coordinates(const PlyElement& element) {
    int found = 0;
    for (const PlyProperty& property : element.properties) {
      if (!property.count && (property.name == "x" || property.name == "y" || property.name == "z")) ++found;
    }
    return found == 3;
  }

  static bool is_corner_list(const PlyProperty& property) {
    return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  static bool has_corners(const PlyElement& element) {
    for (const PlyProperty& property : element.properties) {
      if (is_corner_list(property)) return true;
    }
    return false;
  }

  std::string place_of(const PlyElement& element, long long index) const {
    return element.name + " " + std::to_string(index + 1) + " of " + std::to_string(element.count);
  }

  double next_number(PlyNumber number, const PlyElement& element, long long index) {
    return is_text_ ? next_text_number(element, index) : next_binary_number(number, element, index);
  }

  double next_text_number(const PlyElement& element, long long index) {
    while (!rest_.empty() && static_cast<unsigned char>(rest_.front()) <= ' ') {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
    std::size_t length = 0;
    while (length < rest_.size() && static_cast<unsigned char>(rest_[length]) > ' ') ++length;
    if (length == 0)
      fail("the mesh breaks off in " + place_of(element, index) + "; expected as many as the header says");
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    const std::optional<double> number = parse_number(word);
    if (!number) fail(place_of(element, index) + ": found " + in_quotes(word) + "; expected a number");
    return *number;
  }

  template <typename Value>
  double binary_value(const PlyElement& element, long long index) {
    if (rest_.size() < sizeof(Value)) {
      fail("the mesh breaks off in " + place_of(element, index) + "; expected as many as the header says");
    }
    std::array<char, sizeof(Value)> bytes{};
    std::memcpy(bytes.data(), rest_.data(), sizeof(Value));
    if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
    rest_.remove_prefix(sizeof(Value));
    return static_cast<double>(std::bit_cast<Value>(bytes));
  }

  double next_binary_number(PlyNumber number, const PlyElement& element, long long index) {
    switch (number) {
      case PlyNumber::int8:
        return binary_value<std::int8_t>(element, index);
      case PlyNumber::uint8:
        return binary_value<std::uint8_t>(element, index);
      case PlyNumber::int16:
        return binary_value<std::int16_t>(element, index);
      case PlyNumber::uint16:
        return binary_value<std::uint16_t>(element, index);
      case PlyNumber::int32:
        return binary_value<std::int32_t>(element, index);
      case PlyNumber::uint32:
        return binary_value<std::uint32_t>(element, index);
      case PlyNumber::float32:
        return binary_value<float>(element, index);
      default:
        return binary_value<double>(element, index);
    }
  }

  std::size_t list_length(const PlyProperty& property, const PlyElement& element, long long index) {
    const double length = next_number(*property.count, element, index);
    if (!(length >= 0.0) || length > static_cast<double>(rest_.size()) || length != std::floor(length)) {
      fail(place_of(element, index) + ": a list of " + number_text(length) + "; expected no more than follows");
    }
    return static_cast<std::size_t>(length);
  }

  void read_one(const PlyElement& element, long long index) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    Vec3 position_m(0.0);
    for (const PlyProperty& property : element.properties) {
      if (!property.count) {
        const double value = next_number(property.number, element, index);
        for (int axis = 0; axis < 3; ++axis) {
          if (property.name.size() == 1 && property.name[0] == "xyz"[axis]) position_m[axis] = value;
        }
        continue;
      }
      std::vector<std::size_t> list;
      const std::size_t length = list_length(property, element, index);
      for (std::size_t entry = 0; entry < length; ++entry) {
        list.push_back(corner_index(next_number(property.number, element, index), element, index,
                                    is_face && is_corner_list(property)));
      }
      if (!is_face || !is_corner_list(property)) continue;
      if (list.size() < 3) {
        ++mesh_.faces_without_area;
      } else {
        mesh_.faces.push_back(std::move(list));
      }
    }
    if (is_vertex) add_vertex(position_m, element, index);
  }

  std::size_t corner_index(double value, const PlyElement& element, long long index, bool counts) const {
    if (!counts) return 0;
    if (!(value >= 0.0) || value > 4294967295.0 || value != std::floor(value)) {
      fail(place_of(element, index) + ": corner " + number_text(value) + "; expected the number of a vertex");
    }
    return static_cast<std::size_t>(value);
  }

  void add_vertex(const Vec3& position_m, const PlyElement& element, long long index) {
    constexpr double farthest_m = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(position_m[axis]) <= farthest_m) continue;  // false of what is no number
      fail(place_of(element, index) + ": a coordinate is not within 1e9; expected metres");
    }
    mesh_.vertices_m.push_back(position_m);
  }

  /// Files may end with blanks or an end of line.
  void check_end() const {
    if (rest_.find_first_not_of(" \t\r\n") != std::string_view::npos) {
      fail("more follows than the header counts; expected the end of the mesh");
    }
  }

  void check_indices() const {
    for (std::size_t face = 0; face < mesh_.faces.size(); ++face) {
      for (const std::size_t corner : mesh_.faces[face]) {
        if (corner < mesh_.vertices_m.size()) continue;
        throw InputError(name_, "face " + std::to_string(face + 1) + " has corner " + std::to_string(corner) +
                                    "; expected less than the " + std::to_string(mesh_.vertices_m.size()) +
                                    " vertices");
      }
    }
  }

  std::string name_, bytes_;
  std::string_view rest_;
  std::size_t line_ = 0;
  bool is_text_ = true, in_body_ = false;
  std::vector<PlyElement> elements_;
  PlyMesh mesh_;
};

}  // namespace

PlyMesh read_ply(const std::filesystem::path& file) {
  return PlyReader(file).read();
}

}  // namespace dcem::io
