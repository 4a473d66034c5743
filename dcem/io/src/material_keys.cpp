#include "dcem/io/src/material_keys.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text_input.hpp"

namespace dcem::io {

namespace {

constexpr std::string_view prefix = "em_";
constexpr const char* known_models = "pec, constant, dielectric, itu or multilayer";

/// What may stand under a key. The upper limits only keep out slips of units and of the keyboard.
struct KeyRule {
  std::string_view name;
  std::optional<NumberRange> range = {};  ///< absent: text or layers
  bool later_version = false;
};

constexpr std::array<KeyRule, 15> rules{{
    {"model"},
    {"itu"},
    {"relative_permittivity", NumberRange{1.0, 1e6}},
    {"conductivity_s_per_m", NumberRange{0.0, 1e12}},
    {"thickness_m", NumberRange{0.0, 1e3, true}},
    {"reflection", NumberRange{0.0, 1.0}},
    {"penetration_loss_db", NumberRange{0.0, 1e3}},
    {"scattering", {}, true},
    {"scattering_pattern", {}, true},
    {"scattering_lobe", {}, true},
    {"scattering_back_lobe", {}, true},
    {"scattering_forward_share", {}, true},
    {"roughness_rms_m", NumberRange{0.0, 1.0}},
    {"foliage_db_per_m", {}, true},
    {"layers"},
}};

const KeyRule* find_rule(const std::string& name) {
  const auto rule = std::find_if(rules.begin(), rules.end(), [&](const KeyRule& other) { return other.name == name; });
  return rule == rules.end() ? nullptr : &*rule;
}

/// Makes one material out of its keys.
class MaterialMaker {
 public:
  MaterialMaker(const std::string& name, const MaterialKeys& keys) : name_(name), keys_(keys) {}

  std::optional<Material> make() const {
    if (find("roughness_rms_m") && find("scattering"))
      find("roughness_rms_m")->fail("does not go with 'scattering'; expected one of the two");
    for (const auto& [name, key] : keys_.keys) refuse_later(name, key);
    const std::string model = model_name();
    if (model.empty()) return std::nullopt;
    const Material material{name_, make_model(model), number("roughness_rms_m").value_or(0.0)};
    check(material);
    return material;
  }

 private:
  static void refuse_later(const std::string& name, const MaterialKey& key) {
    const KeyRule* rule = find_rule(name);
    if (rule && rule->later_version) key.fail("not in this version; expected no such key");
  }

  const MaterialKey* find(const std::string& name) const {
    const auto key = keys_.keys.find(name);
    return key == keys_.keys.end() ? nullptr : &key->second;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(keys_.place, "material " + in_quotes(name_) + ": " + what);
  }

  /// What `model` says, or else what the other keys and the name can only mean.
  std::string model_name() const {
    if (const MaterialKey* key = find("model")) return std::get<std::string>(key->value);
    if (find("itu")) return "itu";
    if (find("reflection")) return "constant";
    if (find("relative_permittivity")) return "dielectric";
    if (find("layers")) return "multilayer";
    if (itu_name_from_material_name(name_)) return "itu";
    if (!keys_.keys.empty()) fail("has keys but no model; expected a key 'model' (em_model in an MTL file)");
    return {};
  }

  MaterialModel make_model(const std::string& model) const {
    if (model == "pec") return allow({}), PerfectConductor{};
    if (model == "constant") return make_constant();
    if (model == "dielectric") return make_dielectric();
    if (model == "itu") return make_itu();
    if (model == "multilayer") return make_multilayer();
    find("model")->fail("unknown model " + in_quotes(model) + "; expected " + known_models);
  }

  ConstantReflection make_constant() const {
    allow({"reflection", "penetration_loss_db"});
    return {required_number("reflection"), number("penetration_loss_db")};
  }

  Dielectric make_dielectric() const {
    allow({"relative_permittivity", "conductivity_s_per_m", "thickness_m"});
    return {required_number("relative_permittivity"), number("conductivity_s_per_m").value_or(0.0),
            number("thickness_m")};
  }

  ItuMaterial make_itu() const {
    allow({"itu", "thickness_m"});
    const MaterialKey* key = find("itu");
    const std::optional<std::string> name = key ? itu_name(*key) : itu_name_from_material_name(name_);
    if (!name) fail("model 'itu' needs a key 'itu'; expected the name of a material of ITU-R P.2040");
    return {*name, number("thickness_m")};
  }

  Multilayer make_multilayer() const {
    allow({"layers"});
    const MaterialKey* key = find("layers");
    if (!key) fail("model 'multilayer' lacks the key 'layers'; expected a list of layers in the scenario's materials");
    const auto& layers = std::get<std::vector<MaterialLayer>>(key->value);
    if (layers.empty()) key->fail("empty; expected at least one layer");
    return {layers};
  }

  /// Refuses keys that would have no effect under this model. Any surface may be rough.
  void allow(std::vector<std::string_view> names) const {
    names.push_back("roughness_rms_m");
    for (const auto& [name, key] : keys_.keys) {
      if (name == "model" || std::find(names.begin(), names.end(), name) != names.end()) continue;
      std::string expected;
      for (const std::string_view other : names) expected += (expected.empty() ? "" : ", ") + std::string(other);
      key.fail("does not go with model '" + model_name() + "'; expected " + expected);
    }
  }

  std::optional<double> number(const std::string& name) const {
    const MaterialKey* key = find(name);
    if (!key) return std::nullopt;
    return std::get<double>(key->value);
  }

  double required_number(const std::string& name) const {
    const std::optional<double> value = number(name);
    if (!value) fail("model '" + model_name() + "' lacks the key '" + name + "'; expected a number");
    return *value;
  }

  void check(const Material& material) const {
    try {
      validate(material);
    } catch (const std::invalid_argument& error) {
      throw InputError(keys_.place, std::string(error.what()) + "; expected a material that nature could make");
    }
  }

  const std::string& name_;
  const MaterialKeys& keys_;
};

}  // namespace

void MaterialKey::fail(const std::string& what) const {
  throw InputError(place, printable(spelling) + ": " + what);
}

const std::vector<std::string>& material_key_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const KeyRule& rule : rules) all.emplace_back(rule.name);
    return all;
  }();
  return names;
}

const NumberRange* material_number_range(const std::string& name) {
  const KeyRule* rule = find_rule(name);
  return rule && rule->range ? &*rule->range : nullptr;
}

std::string itu_name(const MaterialKey& key) {
  const std::string& given = std::get<std::string>(key.value);
  if (const std::optional<std::string> name = canonical_itu_name(given)) return *name;
  std::vector<std::string> names = itu_material_names(3);
  for (const std::string& name : itu_material_names(4)) names.push_back(name);
  key.fail("unknown ITU-R P.2040 material " + in_quotes(given) + "; the nearest known one is '" +
           nearest_name(given, names) + "'");
}

MaterialKeys keys_from_mtl(const MtlMaterial& mtl) {
  MaterialKeys result{mtl.file + ":" + std::to_string(mtl.line), {}};
  for (const auto& [spelling, entry] : mtl.em_keys) {
    const std::string name = spelling.substr(prefix.size());
    MaterialKey key{entry.value, mtl.file + ":" + std::to_string(entry.line), spelling};
    const KeyRule* rule = find_rule(name);
    if (name == "layers" || (name == "model" && entry.value == "multilayer"))
      key.fail("layers do not fit in an MTL file; expected them in the scenario's materials");
    if (!rule) {
      key.fail("unknown key; the nearest known one is '" + std::string(prefix) +
               nearest_name(name, material_key_names()) + "'");
    }
    if (rule->range) {
      const std::optional<double> number = parse_number(entry.value);
      if (!number || !rule->range->holds(*number))
        key.fail("found " + in_quotes(entry.value) + "; expected " + rule->range->text());
      key.value = *number;
    }
    result.keys.emplace(name, std::move(key));
  }
  return result;
}

MaterialKeys merged(const MaterialKeys& from_mtl, const MaterialKeys& from_scenario) {
  MaterialKeys result = from_scenario;
  const auto old_model = from_mtl.keys.find("model"), new_model = from_scenario.keys.find("model");
  const bool other_model = new_model != from_scenario.keys.end() && old_model != from_mtl.keys.end() &&
                           new_model->second.value != old_model->second.value;
  if (!other_model) result.keys.insert(from_mtl.keys.begin(), from_mtl.keys.end());
  return result;
}

bool same_definition(const MaterialKeys& a, const MaterialKeys& b) {
  return std::equal(a.keys.begin(), a.keys.end(), b.keys.begin(), b.keys.end(), [](const auto& x, const auto& y) {
    return x.first == y.first && x.second.value == y.second.value;
  });
}

std::optional<Material> make_material(const std::string& name, const MaterialKeys& keys) {
  return MaterialMaker(name, keys).make();
}

std::optional<Material> material_from_mtl(const std::string& name, const MtlMaterial* mtl) {
  return make_material(name, mtl ? keys_from_mtl(*mtl) : MaterialKeys{});
}

}  // namespace dcem::io
