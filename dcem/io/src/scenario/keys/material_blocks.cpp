#include <algorithm>

#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/keys/rule_words.hpp"

namespace dcem::io::keys {

namespace {

// The upper limits only keep out slips of units and of the keyboard.

KeyRule itu_key(const Absence& absence) {
  std::vector<std::string> names = itu_material_names(3);
  for (const std::string& name : itu_material_names(4)) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return {"itu", {text()}, absence, "Name of a material of ITU-R P.2040: " + enumeration(names) + ".", R"("concrete")"};
}

KeyRule permittivity_key(const Absence& absence) {
  return {"relative_permittivity", {number({1.0, 1e6})}, absence, "Real part, the same at every frequency.", "5.24"};
}

KeyRule conductivity_key() {
  return {"conductivity_s_per_m",
          {number({0.0, 1e12}, "S/m")},
          standard(0.0),
          "Goes with relative_permittivity only.",
          "0.05"};
}

KeyRule thickness_key(const Absence& absence, const std::string& meaning) {
  return {"thickness_m", {number({0.0, 1e3, true}, "m")}, absence, meaning, "0.2"};
}

const BlockRule& layer_block() {
  static const BlockRule rule{"materials.*.layers[]",
                              "A medium with its thickness.",
                              {{"model",
                                {word({"itu", "dielectric"})},
                                told("what the other keys say"),
                                "May stand here, but need not.",
                                R"("dielectric")"},
                               itu_key(chosen()),
                               permittivity_key(chosen()),
                               conductivity_key(),
                               thickness_key(required(), "Of the layer.")},
                              {{"medium", {"itu", "relative_permittivity"}}}};
  return rule;
}

std::vector<KeyRule> keys_of_models() {
  return {
      {"model",
       {word({"pec", "constant", "dielectric", "itu", "multilayer"})},
       told("what the other keys can only mean; a name such as itu_concrete is of the model itu"),
       "pec: perfect conductor; constant: one amplitude; dielectric and itu: half space or slab; multilayer: layers, "
       "in "
       "JSON only.",
       R"("constant")"},
      itu_key(required("with model itu, unless the name of the material says it")),
      permittivity_key(required("with model dielectric")),
      conductivity_key(),
      thickness_key(told("a half space: opaque"),
                    "Of a slab of dielectric or itu, that of each sheet that is crossed."),
      {"reflection",
       {number({0.0, 1.0})},
       required("with model constant"),
       "Amplitude of the reflection at every angle; 1 is a perfect conductor.",
       "0.8"},
      {"penetration_loss_db", {number({0.0, 1e3}, "dB")}, told("opaque"), "Of one crossing of model constant.", "20"},
      {"layers",
       {list(block(layer_block()), 1, "layer")},
       required("with model multilayer"),
       "Media one behind the other, in JSON only.",
       ""},
      {"foliage_db_per_m",
       {number({0.0, 1e3}, "dB/m"), word({"auto"})},
       told("no foliage"),
       "Loss inside a closed shell of it; auto is 0.79 f^0.61, f in GHz. Goes without a model.",
       "2.5"},
  };
}

std::vector<KeyRule> keys_of_roughness() {
  static const Scattering standards{};
  const ValueRule lobe = whole_number(1, highest_scattering_lobe);
  return {
      {"roughness_rms_m",
       {number({0.0, 1.0}, "m")},
       standard(0.0),
       "Height deviation of the surface: what is reflected falls (Ament). Not together with scattering.",
       "0.001"},
      {"scattering",
       {number({0.0, 1.0})},
       standard(standards.coefficient),
       "Share S of the reflected amplitude that is scattered.",
       "0.4"},
      {"scattering_pattern",
       {word<ScatteringPattern>()},
       standard(standards.pattern),
       "Where it is scattered to. Goes with scattering only.",
       R"("directive")"},
      {"scattering_lobe",
       {lobe},
       standard(standards.lobe),
       "Exponent of the lobe; the higher, the narrower. Goes with directive and backscattering only.",
       "4"},
      {"scattering_back_lobe",
       {lobe},
       standard(standards.back_lobe),
       "The same of the lobe towards the source. Goes with backscattering only.",
       "4"},
      {"scattering_forward_share",
       {number({0.0, 1.0})},
       standard(standards.forward_share),
       "Weight of the forward lobe. Goes with backscattering only.",
       "0.5"},
  };
}

}  // namespace

const BlockRule& material_block() {
  static const BlockRule rule = [] {
    BlockRule material{
        "materials.*", "The material of that name; the same keys, with em_ in front, stand in MTL files.", {}};
    for (KeyRule& key : keys_of_models()) material.keys.push_back(std::move(key));
    for (KeyRule& key : keys_of_roughness()) material.keys.push_back(std::move(key));
    material.mtl_prefix = "em_";
    return material;
  }();
  return rule;
}

}  // namespace dcem::io::keys
