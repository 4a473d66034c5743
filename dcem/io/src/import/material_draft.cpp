#include "dcem/io/src/import/material_draft.hpp"

#include <stdexcept>
#include <utility>

#include "dcem/em/surface/itu_p2040.hpp"
#include "dcem/io/input_error.hpp"

namespace dcem::io {

MaterialDraft::MaterialDraft(std::string name, std::string place, std::string look)
    : name_(std::move(name)), lines_(std::move(look)), keys_{std::move(place), {}} {}

void MaterialDraft::add(const std::string& key, const std::string& text, const std::string& place,
                        const std::string& spelling) {
  MaterialKey entry = key_from_text(key, text, place, spelling);
  if (key == "itu") itu_name(entry);
  keys_.keys.insert_or_assign(key, std::move(entry));
  lines_ += "em_" + key + ' ' + text + '\n';
}

/// A scenario that an importer writes uses the tables as they are: no other revision, no extrapolation.
void MaterialDraft::check(double frequency_hz, const std::string& frequency_place) const {
  const std::optional<Material> material = make_material(name_, keys_);
  if (!material) return;
  for (const std::string& itu : itu_names(*material)) {
    try {
      itu_properties(itu, frequency_hz, ItuSettings{});
    } catch (const std::invalid_argument& error) {
      throw InputError(frequency_place, "frequency: material " + in_quotes(name_) + ": " + error.what() +
                                            "; expected a material and a frequency of the table (--frequency-hz)");
    }
  }
}

}  // namespace dcem::io
