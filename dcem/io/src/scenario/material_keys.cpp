#include "dcem/io/src/scenario/material_keys.hpp"
#include "dcem/em/surface/itu_p2040.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "dcem/io/input_error.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// What a material with a loss per metre is; no word of the files.
constexpr const char* foliage_model = "foliage";

/// The words that may stand under a key: "lambertian, directive or backscattering".
std::string words_under(const char* key) {
  return keys::text_of(keys::find_key(keys::material_block(), key)->forms);
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
    find("model")->fail("unknown model " + in_quotes(model) + "; expected " + words_under("model"));
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
    scattering.lobe = static_cast<int>(number("scattering_lobe").value_or(scattering.lobe));
    scattering.back_lobe = static_cast<int>(number("scattering_back_lobe").value_or(scattering.back_lobe));
    scattering.forward_share = number("scattering_forward_share").value_or(scattering.forward_share);
    return scattering;
  }

  ScatteringPattern scattering_pattern() const {
    const MaterialKey* key = find("scattering_pattern");
    if (!key) return ScatteringPattern::lambertian;
    if (!find("scattering")) key->fail("goes with 'scattering' only; expected that key, too");
    const std::string& name = std::get<std::string>(key->value);
    const auto pattern = meaning_of<ScatteringPattern>(name);
    if (!pattern) key->fail("unknown pattern " + in_quotes(name) + "; expected " + words_under("scattering_pattern"));
    return *pattern;
  }

  /// Refuses a key that is there although the condition does not hold.
  void require(bool condition, const std::string& name, const std::string& what) const {
    if (const MaterialKey* key = find(name); key && !condition) key->fail(what + "; expected no such key");
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

std::string itu_name(const MaterialKey& key) {
  const std::string& given = std::get<std::string>(key.value);
  if (const std::optional<std::string> name = canonical_itu_name(given)) return *name;
  std::vector<std::string> names = itu_material_names(3);
  for (const std::string& name : itu_material_names(4)) names.push_back(name);
  key.fail("unknown ITU-R P.2040 material " + in_quotes(given) + "; the nearest known one is '" +
           nearest_name(given, names) + "'");
}

namespace {

/// The number or the word that a line of an MTL file holds.
std::variant<double, std::string, std::vector<MaterialLayer>> value_from_mtl(const MaterialKey& key,
                                                                             const keys::KeyRule& rule,
                                                                             const std::string& text) {
  const keys::ValueRule* whole = keys::find_form(rule.forms, keys::ValueKind::whole_number);
  const keys::ValueRule* number = whole ? whole : keys::find_form(rule.forms, keys::ValueKind::number);
  const keys::ValueRule* word = keys::find_form(rule.forms, keys::ValueKind::word);
  if (number == nullptr || (word != nullptr && text == word->words.front())) return text;
  const std::optional<double> value = parse_number(text);
  if (!value || !number->range.holds(*value) || (whole && *value != std::floor(*value)))
    key.fail("found " + in_quotes(text) + "; expected " + keys::text_of(rule.forms));
  return *value;
}

}  // namespace

MaterialKey key_from_text(const std::string& name, const std::string& text, std::string place, std::string spelling) {
  const keys::BlockRule& block = keys::material_block();
  MaterialKey key{text, std::move(place), std::move(spelling)};
  const keys::KeyRule* rule = keys::find_key(block, name);
  if ((rule && !keys::fits_mtl(block, *rule)) || (name == "model" && text == "multilayer"))
    key.fail("layers do not fit in an MTL file; expected them in the scenario's materials");
  if (!rule) key.fail("unknown key" + expected_names(key.spelling, keys::mtl_names(block)));
  key.value = value_from_mtl(key, *rule, text);
  return key;
}

MaterialKeys keys_from_mtl(const MtlMaterial& mtl) {
  const std::size_t prefix = keys::material_block().mtl_prefix.size();
  MaterialKeys result{mtl.file + ":" + std::to_string(mtl.line), {}};
  for (const auto& [spelling, entry] : mtl.em_keys) {
    const std::string name = spelling.substr(prefix);
    result.keys.emplace(name, key_from_text(name, entry.value, mtl.file + ":" + std::to_string(entry.line), spelling));
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
