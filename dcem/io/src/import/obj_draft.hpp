#pragma once
/// An OBJ file that grows triangle by triangle. Private to dcem::io.
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

class ObjDraft {
 public:
  /// The faces that follow are of this group: `g house_7`.
  void start_group(const std::string& name);
  void face(const std::string& material, const std::vector<Vec3>& corners_m);

  std::size_t faces() const { return faces_; }
  bool empty() const { return faces_ == 0; }
  const std::set<std::string>& materials() const { return materials_; }
  /// The file; corners with the same coordinates are one vertex.
  std::string text(const std::string& comment, const std::string& mtl_file) const;

 private:
  std::map<std::tuple<double, double, double>, std::size_t> vertex_of_;
  std::string vertices_, faces_text_, material_;
  std::set<std::string> materials_;
  std::size_t faces_ = 0;
};

/// A name as OBJ and MTL files take it: one word.
std::string obj_word(const std::string& name);

}  // namespace dcem::io
