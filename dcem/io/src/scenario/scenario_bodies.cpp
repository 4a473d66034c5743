#include <algorithm>

#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/checks/mesh_doubts.hpp"
#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {

namespace {

/// A step of millions of vehicles is a compressed file of some megabytes.
constexpr std::size_t most_vehicles = 100'000;
constexpr double vehicle_bytes = 15e3;  ///< measured: box, facets, edges and tree

void require_few_vehicles(const Traffic& traffic, const JsonValue& mobility) {
  std::size_t vehicles = 0;
  for (const Traffic::Type& type : traffic.types) vehicles += type.slots;
  if (vehicles <= most_vehicles) return;
  mobility.member("sumo_fcd")
      .fail(std::to_string(vehicles) + " vehicles at a time need " +
            memory_text(vehicle_bytes * static_cast<double>(vehicles)) + "; expected at most " +
            std::to_string(most_vehicles));
}

ObjSettings read_obj_settings(const JsonObject& owner) {
  ObjSettings settings;
  settings.up = read_word(owner, "up", settings.up);
  settings.unit_m = owner.number("unit_m", settings.unit_m);
  return settings;
}

/// A layer is told by the keys of the models `dielectric` and `itu`; `model` may stand there but need not.
MaterialLayer read_layer(const JsonValue& value) {
  const JsonObject layer = value.object();
  const bool is_itu = layer.chosen("medium") == "itu";
  const std::string model = is_itu ? "itu" : "dielectric";
  if (layer.has("model") && layer.at("model").word() != model) layer.at("model").fail_expected(model);
  const double thickness_m = layer.at("thickness_m").number();
  if (!is_itu) {
    return Dielectric{layer.at("relative_permittivity").number(), layer.number("conductivity_s_per_m", 0.0),
                      thickness_m};
  }
  if (layer.has("conductivity_s_per_m"))
    layer.at("conductivity_s_per_m").fail("goes with relative_permittivity only; expected no such key");
  const JsonValue itu = layer.at("itu");
  return ItuMaterial{itu_name({itu.text(), itu.place(), itu.path()}), thickness_m};
}

std::vector<MaterialLayer> read_layers(const JsonValue& value) {
  std::vector<MaterialLayer> layers;
  for (const JsonValue& element : value.elements()) layers.push_back(read_layer(element));
  return layers;
}

/// Which words and which keys go together is looked at when a material is made of them, as for MTL files.
MaterialKey read_material_key(const JsonValue& value) {
  using keys::ValueKind;
  MaterialKey key{0.0, value.place(), value.path()};
  const bool is_number = value.may_be(ValueKind::number);
  if (value.may_be(ValueKind::list)) {
    key.value = read_layers(value);
  } else if (value.may_be(ValueKind::whole_number)) {
    key.value = static_cast<double>(value.integer());
  } else if (is_number && value.may_be(ValueKind::word) && !value.is_number()) {
    key.value = value.word();
  } else if (is_number) {
    key.value = value.number();
  } else {
    key.value = value.text();
  }
  return key;
}

/// What objects with `"foliage": true` are made of.
const std::string foliage_material = "foliage";

/// A mesh whose surfaces are all the skin of foliage, whatever they were in its file.
TriangleMesh all_of_foliage(TriangleMesh mesh) {
  mesh.material_names = {foliage_material};
  for (TriangleMesh::Triangle& triangle : mesh.triangles) triangle.material = 0;
  return mesh;
}

}  // namespace

void BodyLoader::load() {
  const JsonObject scene = scenario_.at("scene").object();
  result_.scene = Scene(read_surface_settings(scene));
  read_scenario_materials();
  const ObjFile& scenery = read_mesh(scene);
  read_objects();
  if (result_.traffic) {
    const JsonValue material = scenario_.at("mobility").member("material");
    used_materials_.try_emplace(material.line(), material.place());
  }
  add_materials();
  reported_at(scene.at("obj"), [&] { result_.scene.set_scenery(scenery.mesh); });
  if (result_.scene.facets().empty()) scene.at("obj").fail("no face has an area; expected at least one");
  warn(scene.at("obj"), "the mesh " + in_quotes(scene.at("obj").text()), mesh_doubts(scenery.mesh));
  for (Object& object : objects_) {
    const bool is_foliage = object.mesh.material_names == std::vector{foliage_material};
    // All woods of a town are one object.
    if (!is_foliage) warn(object.value, "the object " + in_quotes(object.id), object_doubts(object.mesh));
    reported_at(object.value, [&] { result_.scene.add_object(object.id, object.mesh, std::move(object.motion)); });
  }
  if (result_.traffic) add_traffic();
}

void BodyLoader::warn(const JsonValue& place, const std::string& subject, const std::vector<std::string>& doubts) {
  for (const std::string& doubt : doubts) {
    result_.warnings.push_back(place.place() + ": " + place.path() + ": " + subject + " " + doubt);
  }
}

void BodyLoader::add_traffic() {
  const JsonValue mobility = scenario_.at("mobility");
  const std::string material = mobility.member("material").line();
  require_few_vehicles(*result_.traffic, mobility);
  for (Traffic::Type& type : result_.traffic->types) {
    type.first_body = result_.scene.bodies().size();
    reported_at(mobility, [&] { result_.scene.add_body_pool(type.slots, make_box(type.size_m, material)); });
  }
}

void BodyLoader::check_object_id(const JsonValue& id) const {
  const std::string name = id.identifier();
  const bool known =
      std::any_of(objects_.begin(), objects_.end(), [&](const Object& other) { return other.id == name; });
  if (known) id.fail(in_quotes(name) + " is there twice; expected a new id");
  if (result_.traffic && result_.traffic->presence.contains(name)) {
    id.fail(in_quotes(name) + " is also a vehicle of the trace; expected a new id");
  }
}

const ObjFile& BodyLoader::read_mesh(const JsonObject& owner) {
  const ObjFile& read = read_file(owner);
  collect_used_materials(read, existing_file(owner.at("obj"), folder_, "expected an OBJ file").string());
  return read;
}

const ObjFile& BodyLoader::read_file(const JsonObject& owner) {
  const JsonValue name = owner.at("obj");
  const std::filesystem::path file = existing_file(name, folder_, "expected an OBJ file");
  const ObjSettings settings = read_obj_settings(owner);
  const FileKey key{file.string(), settings.up, settings.unit_m};
  const auto known = files_.find(key);
  if (known != files_.end()) return known->second;
  const ObjFile& read = files_.emplace(key, read_obj(file, settings)).first->second;
  collect_mtl_materials(read);
  result_.warnings.insert(result_.warnings.end(), read.warnings.begin(), read.warnings.end());
  return read;
}

TriangleMesh BodyLoader::read_object_mesh(const JsonObject& object) {
  const bool foliage = object.boolean("foliage", false);
  if (foliage) {
    if (object.has("material")) object.at("material").fail("does not go with foliage; expected no such key");
    foliage_objects_.push_back(object.at("foliage"));
    used_materials_.try_emplace(foliage_material, object.at("foliage").place());
  }
  if (object.chosen("shape") == "obj") {
    if (object.has("material")) object.at("material").fail("goes with box_m only; expected no such key");
    return foliage ? all_of_foliage(read_file(object).mesh) : read_mesh(object).mesh;
  }
  for (const char* key : {"up", "unit_m"}) {
    if (object.has(key)) object.at(key).fail("goes with obj only; expected no such key");
  }
  const Vec3 size_m = object.at("box_m").vector3();
  if (foliage) return make_box(size_m, foliage_material);
  const JsonValue material = object.at("material");
  used_materials_.try_emplace(material.line(), material.place());
  return make_box(size_m, material.line());
}

void BodyLoader::read_objects() {
  const auto list = scenario_.find("objects");
  if (!list) return;
  for (const JsonValue& element : list->elements()) {
    const JsonObject object = element.object();
    check_object_id(object.at("id"));
    const std::string id = object.at("id").text();
    const auto motion = object.find("motion");
    objects_.push_back(
        {element, id, read_object_mesh(object), motion ? motions_.read(*motion, id) : Motion(LinearMotion{})});
  }
}

void BodyLoader::collect_used_materials(const ObjFile& file, const std::string& name) {
  const TriangleMesh& mesh = file.mesh;
  std::vector<bool> used(mesh.material_names.size(), false);
  for (const TriangleMesh::Triangle& triangle : mesh.triangles) used[triangle.material] = true;
  for (std::size_t index = 0; index < used.size(); ++index) {
    const std::string& material = mesh.material_names[index];
    if (used[index]) used_materials_.try_emplace(material, name + ":" + std::to_string(file.used_at.at(material)));
  }
}

void BodyLoader::collect_mtl_materials(const ObjFile& file) {
  for (const auto& [name, mtl] : file.materials) {
    MaterialKeys keys = keys_from_mtl(mtl);
    std::vector<MaterialKeys>& definitions = mtl_materials_[name];
    const bool known = std::any_of(definitions.begin(), definitions.end(),
                                   [&](const MaterialKeys& other) { return same_definition(other, keys); });
    if (!known) definitions.push_back(std::move(keys));
  }
}

void BodyLoader::read_scenario_materials() {
  const auto block = scenario_.find("materials");
  if (!block) return;
  for (const auto& [name, value] : block->entries()) {
    const JsonObject object = value.object(keys::material_block());
    if (!is_printable(name)) value.fail("the name holds control characters; expected a name on one line");
    MaterialKeys definition{value.place(), {}};
    for (const keys::KeyRule& key : keys::material_block().keys) {
      if (const auto found = object.find(key.name)) definition.keys.emplace(key.name, read_material_key(*found));
    }
    scenario_materials_.emplace(name, std::move(definition));
  }
}

/// The keys of a material from all files together.
MaterialKeys BodyLoader::definition(const std::string& name) const {
  const auto in_mtl = mtl_materials_.find(name);
  const auto in_scenario = scenario_materials_.find(name);
  const bool overrides = in_scenario != scenario_materials_.end();
  if (in_mtl == mtl_materials_.end()) {
    return overrides ? in_scenario->second : MaterialKeys{used_materials_.at(name), {}};
  }
  const std::vector<MaterialKeys>& definitions = in_mtl->second;
  if (definitions.size() == 1) return overrides ? merged(definitions[0], in_scenario->second) : definitions[0];
  if (overrides && in_scenario->second.keys.contains("model")) return in_scenario->second;
  throw InputError(definitions[1].place,
                   "material " + in_quotes(name) + " differs from " + definitions[0].place +
                       "; expected one definition, or a model for it in the scenario's materials");
}

void BodyLoader::add_materials() {
  for (const auto& [name, used_at] : used_materials_) {
    const MaterialKeys keys = definition(name);
    std::optional<Material> material = make_material(name, keys);
    const bool of_objects = name == foliage_material && !foliage_objects_.empty();
    if (of_objects && !material) material = Material{name, Foliage{}};
    if (of_objects && !is_foliage(*material)) {
      foliage_objects_.front().fail("material 'foliage' is defined as something else; expected foliage_db_per_m in it");
    }
    if (!material) {
      throw InputError(used_at, "material " + in_quotes(name) +
                                    " is used but defined nowhere; expected em_* keys in the MTL file, an entry in "
                                    "the scenario's materials, or a name such as itu_concrete");
    }
    check_frequency(*material);
    result_.scene.add_material(*material);
  }
  for (const auto& [name, keys] : scenario_materials_) {
    if (!used_materials_.contains(name)) make_material(name, keys);  // only to check it
  }
}

void BodyLoader::check_frequency(const Material& material) {
  const JsonValue place = scenario_.at("frequency_hz");
  const SimulationSettings& settings = result_.settings;
  for (const std::string& name : itu_names(material)) {
    try {
      if (!itu_properties(name, settings.frequency_hz, settings.itu).extrapolated) continue;
    } catch (const std::invalid_argument& error) {
      place.fail(in_quotes(material.name) + ": " + error.what() +
                 "; expected a frequency of the table (or itu.allow_extrapolation, or another itu.revision)");
    }
    result_.warnings.push_back(place.place() + ": material " + in_quotes(material.name) + " ('" + name +
                               "' of ITU-R P.2040) is extrapolated to a frequency outside its table");
  }
}

}  // namespace dcem::io
