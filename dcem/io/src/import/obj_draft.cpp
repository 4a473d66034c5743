#include "dcem/io/src/import/obj_draft.hpp"

#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {

std::string obj_word(const std::string& name) {
  std::string word;
  for (const char letter : name) {
    const auto code = static_cast<unsigned char>(letter);
    const bool means_more = code <= ' ' || code == 0x7F || letter == '#' || letter == '\\';
    word += means_more ? '_' : letter;
  }
  return word.empty() ? "_" : word;
}

void ObjDraft::start_group(const std::string& name) {
  faces_text_ += "g " + obj_word(name) + '\n';
}

void ObjDraft::face(const std::string& material, const std::vector<Vec3>& corners_m) {
  if (material != material_) faces_text_ += "usemtl " + material + '\n';
  material_ = material;
  materials_.insert(material);
  faces_text_ += 'f';
  for (const Vec3& corner_m : corners_m) {
    // Adding 0 makes one vertex of -0 and 0.
    const auto key = std::make_tuple(corner_m.x + 0.0, corner_m.y + 0.0, corner_m.z + 0.0);
    const auto [place, is_new] = vertex_of_.emplace(key, vertex_of_.size() + 1);
    if (is_new) {
      vertices_ += 'v';
      for (int axis = 0; axis < 3; ++axis) append_number(vertices_ += ' ', corner_m[axis]);
      vertices_ += '\n';
    }
    append_number(faces_text_ += ' ', place->second);
  }
  faces_text_ += '\n';
  ++faces_;
}

std::string ObjDraft::text(const std::string& comment, const std::string& mtl_file) const {
  return "# " + comment + "\nmtllib " + mtl_file + '\n' + vertices_ + faces_text_;
}

}  // namespace dcem::io
