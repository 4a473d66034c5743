#include "dcem/io/src/scenario/material_keys.hpp"
#include "dcem/em/surface/itu_p2040.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

constexpr std::string_view prefix = "em_";
/// What a material with a loss per metre is; no word of the files.
constexpr const char* foliage_model = "foliage";
constexpr const char* known_models = "pec, constant, dielectric, itu or multilayer";

/// What may stand under a key. The upper limits only keep out slips of units and of the keyboard.
struct KeyRule {
  std::string_view name;
  std::optional<NumberRange> range = {};  ///< absent: text or layers
  std::string_view word = {};             ///< a word that may stand there instead of a number
};

constexpr std::array<KeyRule, 15> rules{{
    {"model"},
    {"itu"},
    {"relative_permittivity", NumberRange{1.0, 1e6}},
    {"conductivity_s_per_m", NumberRange{0.0, 1e12}},
    {"thickness_m", NumberRange{0.0, 1e3, true}},
    {"reflection", NumberRange{0.0, 1.0}},
    {"penetration_loss_db", NumberRange{0.0, 1e3}},
    {"scattering", NumberRange{0.0, 1.0}},
    {"scattering_pattern"},
    {"scattering_lobe", NumberRange{1.0, highest_scattering_lobe}},
    {"scattering_back_lobe", NumberRange{1.0, highest_scattering_lobe}},
    {"scattering_forward_share", NumberRange{0.0, 1.0}},
    {"roughness_rms_m", NumberRange{0.0, 1.0}},
    {"foliage_db_per_m", NumberRange{0.0, 1e3}, "auto"},
    {"layers"},
}};

const KeyRule* find_rule(const std::string& name) {
  const auto rule = std::find_if(rules.begin(), rules.end(), [&](const KeyRule& other) { return other.name == name; });
  return rule == rules.end() ? nullptr : &*rule;
}

std::string alternative(const KeyRule& rule) {
  return rule.word.empty() ? std::string() : " or '" + std::string(rule.word) + "'";
}

/// Makes one material out of its keys.
class MaterialMaker {
 public:
  MaterialMaker(const std::string& name, const MaterialKeys& keys) : name_(name), keys_(keys) {}

  std::optional<Material> make() const {
    if (find("roughness_rms_m") && find("scattering"))
      find("roughness_rms_m")->fail("does not go with 'scattering'; expected one of the two");
    const std::string model = model_name();
    if (model.empty()) return std::nullopt;
    const Material material{name_, make_model(model), number("roughness_rms_m").value_or(0.0), make_scattering()};
    check(material);
    return material;
  }

 private:
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
    if (find("foliage_db_per_m")) return foliage_model;
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
    if (model == foliage_model && !find("model")) return make_foliage();
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

  Foliage make_foliage() const {
    allow_only({"foliage_db_per_m"});
    const auto* value = std::get_if<double>(&find("foliage_db_per_m")->value);
    return value ? Foliage{*value} : Foliage{};
  }

  Scattering make_scattering() const {
    Scattering scattering;
    scattering.coefficient = number("scattering").value_or(0.0);
    scattering.pattern = scattering_pattern();
    const bool back = scattering.pattern == ScatteringPattern::backscattering;
    const bool lobes = scattering.pattern != ScatteringPattern::lambertian;
    require(lobes, "scattering_lobe", "goes with scattering_pattern 'directive' or 'backscattering' only");
    require(back, "scattering_back_lobe", "goes with scattering_pattern 'backscattering' only");
    require(back, "scattering_forward_share", "goes with scattering_pattern 'backscattering' only");
    scattering.lobe = lobe("scattering_lobe").value_or(scattering.lobe);
    scattering.back_lobe = lobe("scattering_back_lobe").value_or(scattering.back_lobe);
    scattering.forward_share = number("scattering_forward_share").value_or(scattering.forward_share);
    return scattering;
  }

  ScatteringPattern scattering_pattern() const {
    const MaterialKey* key = find("scattering_pattern");
    if (!key) return ScatteringPattern::lambertian;
    if (!find("scattering")) key->fail("goes with 'scattering' only; expected that key, too");
    const std::string& name = std::get<std::string>(key->value);
    if (name == "directive") return ScatteringPattern::directive;
    if (name == "backscattering") return ScatteringPattern::backscattering;
    if (name != "lambertian") {
      key->fail("unknown pattern " + in_quotes(name) + "; expected lambertian, directive or backscattering");
    }
    return ScatteringPattern::lambertian;
  }

  /// Refuses a key that is there although the condition does not hold.
  void require(bool condition, const std::string& name, const std::string& what) const {
    if (const MaterialKey* key = find(name); key && !condition) key->fail(what + "; expected no such key");
  }

  std::optional<int> lobe(const std::string& name) const {
    const std::optional<double> value = number(name);
    if (!value) return std::nullopt;
    if (*value != std::floor(*value)) {
      std::string found;
      append_number(found, *value);
      find(name)->fail("found " + in_quotes(found) + "; expected a whole number from 1 to 100");
    }
    return static_cast<int>(*value);
  }

  /// Refuses keys that would have no effect under this model. Any surface may be rough, or scatter.
  void allow(std::vector<std::string_view> names) const {
    names.insert(names.end(), {"roughness_rms_m", "scattering", "scattering_pattern", "scattering_lobe",
                               "scattering_back_lobe", "scattering_forward_share"});
    allow_only(names);
  }

  void allow_only(const std::vector<std::string_view>& names) const {
    for (const auto& [name, key] : keys_.keys) {
      if (name == "model" || std::find(names.begin(), names.end(), name) != names.end()) continue;
      std::string expected;
      for (const std::string_view other : names) expected += (expected.empty() ? "" : ", ") + std::string(other);
      key.fail("does not go with " + model_words() + "; expected " + expected);
    }
  }

  std::string model_words() const {
    const std::string model = model_name();
    return model == foliage_model ? "foliage" : "model '" + model + "'";
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

std::string_view material_word(const std::string& name) {
  const KeyRule* rule = find_rule(name);
  return rule ? rule->word : std::string_view();
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
    if (rule->range && entry.value != rule->word) {
      const std::optional<double> number = parse_number(entry.value);
      if (!number || !rule->range->holds(*number))
        key.fail("found " + in_quotes(entry.value) + "; expected " + rule->range->text() + alternative(*rule));
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
