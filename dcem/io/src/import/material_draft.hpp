#pragma once
/// A material on its way from a source into an MTL file. Private to dcem::io.
#include <string>

#include "dcem/io/src/scenario/material_keys.hpp"

namespace dcem::io {

/// Takes the keys of a material one by one, each checked by the reader of MTL files itself: what a source says of a
/// material is refused where the source says it, not when the scenario is run.
class MaterialDraft {
 public:
  /// `place` is of the material in its source: "scene.xml:7: bsdf 'glazing'". `look`: lines of the MTL file that say
  /// what it looks like.
  MaterialDraft(std::string name, std::string place, std::string look = {});

  /// A key without `em_`, which the source calls `spelling` and says at `place`. Throws InputError.
  void add(const std::string& key, const std::string& text, const std::string& place, const std::string& spelling);
  /// A key of the importer's own.
  void add(const std::string& key, const std::string& text) { add(key, text, keys_.place, key); }
  bool has(const std::string& key) const { return keys_.keys.contains(key); }

  /// Throws InputError where the keys do not make a material, or none for this frequency.
  void check(double frequency_hz, const std::string& frequency_place) const;
  /// What stands behind `newmtl NAME`.
  const std::string& lines() const { return lines_; }

 private:
  std::string name_, lines_;
  MaterialKeys keys_;
};

}  // namespace dcem::io
