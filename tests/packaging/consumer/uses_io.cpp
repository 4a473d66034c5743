#include <cstdio>
#include <fstream>
#include <vector>

#include "dcem/io/input_error.hpp"
#include "dcem/io/npz_writer.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"

/// The writer of arrays needs libzip.
bool writes_arrays() {
  dcem::io::NpzWriter writer;
  writer.add("x", {2}, std::vector<double>{1.0, 2.0});
  dcem::io::AtomicFile file("arrays.npz");
  writer.write(file);
  file.commit();
  return std::ifstream("arrays.npz").get() == 'P';  // as every ZIP archive
}

/// The reader of scenarios needs every other library of dcem::io.
bool refuses_missing_scenario() {
  try {
    dcem::io::load_scenario("nowhere.json");
  } catch (const dcem::io::InputError&) {
    return true;
  }
  return false;
}

int main() {
  // 123456.789 is not a number of single precision: it shows that the double-precision loader was linked.
  std::ofstream("triangle.obj") << "v 123456.789 0 0\nv 123457.789 0 0\nv 123456.789 1 0\nf 1 2 3\n";
  const dcem::io::ObjFile file = dcem::io::read_obj("triangle.obj");
  const bool right = writes_arrays() && refuses_missing_scenario() && file.mesh.triangles.size() == 1 &&
                     file.mesh.vertices_m.at(0).x == 123456.789;
  std::puts(right ? "io works" : "io is wrong");
  return right ? 0 : 1;
}
