#include "dcem/io/src/import/mitsuba_scene.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/xml_reader.hpp"

namespace dcem::io {

namespace {

class MitsubaReader : private XmlHandler {
 public:
  explicit MitsubaReader(const std::filesystem::path& file) : reader_(file, "expected a Mitsuba scene", *this) {}

  MitsubaScene read() {
    reader_.read_on();
    return std::move(scene_);
  }

 private:
  void start_element(std::string_view name, const XmlAttributes& attributes) override {
    if (open_.empty() && name != "scene") reader_.fail("found <" + printable(name) + ">; expected <scene>");
    open_.emplace_back(name);
    if (name == "bsdf") start_material(attributes);
    if (name == "shape") start_shape(attributes);
    if (name == "ref" && is_in("shape") && !is_in("bsdf")) scene_.shapes.back().material = text(attributes, "id");
    if (name == "string") add_word(attributes);
    if (name == "float") add_number(attributes);
    if (is_in("transform") && is_in("shape") && name != "transform") transform(name, attributes);
  }

  void end_element(std::string_view name) override {
    open_.pop_back();
    if (name == "bsdf") material_ids_.pop_back();
  }

  /// Whether an element of this name is open; the one that begins counts.
  bool is_in(std::string_view name) const { return std::find(open_.begin(), open_.end(), name) != open_.end(); }
  bool is_directly_in(std::string_view name) const { return open_.size() > 1 && open_[open_.size() - 2] == name; }

  /// The whole text, however long: names of files and ids must not be cut.
  static std::string text(const XmlAttributes& attributes, const char* name) {
    return without_controls(attributes.find(name).value_or(""));
  }

  /// What wraps another material (`twosided`) has its id; what is inside says no more of radio.
  void start_material(const XmlAttributes& attributes) {
    std::string id = text(attributes, "id");
    const bool is_wrapped = !material_ids_.empty();
    if (is_wrapped) id = material_ids_.back();
    if (id.empty()) id = "material_" + std::to_string(scene_.materials.size() + 1);
    material_ids_.push_back(id);
    if (is_wrapped) return;
    if (scene_.materials.contains(id)) reader_.fail("bsdf " + in_quotes(id) + " is there already; expected a new id");
    scene_.materials[id].type = text(attributes, "type");
    scene_.materials[id].line = reader_.line();
    if (is_in("shape")) scene_.shapes.back().material = id;
  }

  void start_shape(const XmlAttributes& attributes) {
    MitsubaShape shape;
    shape.type = text(attributes, "type");
    shape.id = text(attributes, "id");
    shape.line = reader_.line();
    if (shape.type.empty()) reader_.fail("shape without a type; expected one, as type=\"ply\"");
    if (shape.id.empty()) shape.id = "shape_" + std::to_string(scene_.shapes.size() + 1);
    scene_.shapes.push_back(std::move(shape));
  }

  void add_word(const XmlAttributes& attributes) {
    const std::string name = text(attributes, "name"), value = text(attributes, "value");
    if (is_directly_in("shape") && name == "filename") scene_.shapes.back().file = value;
    if (is_directly_in("bsdf")) scene_.materials[material_ids_.back()].words[name] = {value, reader_.line()};
  }

  void add_number(const XmlAttributes& attributes) {
    if (!is_directly_in("bsdf")) return;
    const std::string name = text(attributes, "name");
    const std::string_view value = attributes.find("value").value_or("");
    const std::optional<double> number = parse_number(trimmed(value));
    if (!number) reader_.fail("float '" + name + "': found " + in_quotes(value) + "; expected a number");
    scene_.materials[material_ids_.back()].numbers[name] = {*number, reader_.line()};
  }

  /// Numbers with blanks or commas between.
  std::vector<double> numbers(const XmlAttributes& attributes, const char* name) const {
    std::string value(attributes.find(name).value_or(""));
    for (char& letter : value) {
      if (letter == ',' || letter == '\n') letter = ' ';
    }
    std::vector<double> found;
    std::string_view rest = value;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const std::optional<double> number = parse_number(word);
      if (!number) reader_.fail(std::string(name) + ": found " + in_quotes(word) + "; expected numbers");
      found.push_back(*number);
    }
    return found;
  }

  /// x, y and z, or three numbers or one in `value`.
  Vec3 vector(const XmlAttributes& attributes, double absent) const {
    std::vector<double> together = numbers(attributes, "value");
    if (together.size() == 1) return Vec3(together[0]);
    if (together.size() == 3) return {together[0], together[1], together[2]};
    Vec3 result(absent);
    for (int axis = 0; axis < 3; ++axis) {
      const char name[2] = {"xyz"[axis], '\0'};
      const std::vector<double> one = numbers(attributes, name);
      if (one.size() == 1) result[axis] = one[0];
    }
    return result;
  }

  /// Each is applied after those before it.
  void transform(std::string_view name, const XmlAttributes& attributes) {
    glm::dmat4& to_world = scene_.shapes.back().to_world;
    if (name == "translate") {
      to_world = glm::translate(glm::dmat4(1.0), vector(attributes, 0.0)) * to_world;
    } else if (name == "scale") {
      to_world = glm::scale(glm::dmat4(1.0), vector(attributes, 1.0)) * to_world;
    } else if (name == "rotate") {
      const Vec3 axis = vector(attributes, 0.0);
      const std::vector<double> angle_deg = numbers(attributes, "angle");
      const double length = glm::length(axis);
      if (angle_deg.size() != 1 || !(length > 0.0) || !std::isfinite(length))
        reader_.fail("rotate: without axis or angle; expected an axis and an angle in degrees");
      to_world = glm::rotate(glm::dmat4(1.0), glm::radians(angle_deg[0]), axis) * to_world;
    } else if (name == "matrix") {
      const std::vector<double> entries = numbers(attributes, "value");
      if (entries.size() != 16) {
        reader_.fail("matrix: found " + std::to_string(entries.size()) + " numbers; expected 16, row by row");
      }
      glm::dmat4 matrix(1.0);
      for (int entry = 0; entry < 16; ++entry) matrix[entry % 4][entry / 4] = entries[static_cast<std::size_t>(entry)];
      to_world = matrix * to_world;
    } else {
      reader_.fail("transform: found " + printable(name) + "; expected translate, scale, rotate or matrix");
    }
  }

  XmlReader reader_;
  MitsubaScene scene_;
  std::vector<std::string> open_;
  std::vector<std::string> material_ids_;  ///< of the open bsdf elements
};

}  // namespace

MitsubaScene read_mitsuba_scene(const std::filesystem::path& file) {
  return MitsubaReader(file).read();
}

}  // namespace dcem::io
