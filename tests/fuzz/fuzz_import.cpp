/// A file of somebody else's scene, as the first line says (poly, osm, pbf, ply, scene, buildings, links), imported
/// among otherwise good ones.
#include "dcem/io/import.hpp"
#include "tests/fuzz/fuzzed_file.hpp"

namespace {

using namespace dcem;

constexpr const char* good_network =
    "<net><location netOffset=\"-500000,-5600000\" convBoundary=\"0,0,200,100\" projParameter=\"+proj=utm +zone=32\"/>"
    "<edge id=\"e\"><lane id=\"e_0\" shape=\"0,0 200,0\"/></edge></net>";
constexpr const char* good_scene =
    "<scene><bsdf type=\"itu-radio-material\" id=\"m\"><string name=\"type\" value=\"concrete\"/></bsdf><shape "
    "type=\"ply\"><string name=\"filename\" value=\"mesh.ply\"/><ref id=\"m\"/></shape></scene>";
constexpr const char* good_buildings = "building_id,x_m,y_m\n1,0,0\n1,9,0\n1,9,9\n";
constexpr const char* good_links = "veh_i,veh_j,x_i,y_i,h_ant_i,x_j,y_j,h_ant_j\n1,2,20,0,1.6,30,0,1.6\n";

void import_bytes(const fuzz::WorkFolder& folder, std::string_view kind, std::string_view bytes) {
  const auto made = folder.write("made/.keep", "").parent_path();
  if (kind == "osm") io::import_osm(folder.write("map.osm", bytes), made);
  if (kind == "pbf") io::import_osm(folder.write("map.osm.pbf", bytes), made);
  if (kind == "poly") {
    io::import_sumo({folder.write("town.net.xml", good_network), folder.write("town.poly.xml", bytes), {}, {}}, made);
  }
  if (kind == "ply") {
    folder.write("mesh.ply", bytes);
    io::import_sionna(folder.write("scene.xml", good_scene), made);
  }
  if (kind == "scene") io::import_sionna(folder.write("scene.xml", bytes), made);
  if (kind == "buildings" || kind == "links") {
    folder.write("a_buildings_xy.csv", kind == "links" ? good_buildings : bytes);
    const auto links = folder.write("links_5.9GHz.csv", kind == "links" ? bytes : good_links);
    io::import_gemv2(links.parent_path(), made);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::WorkFolder folder;
  std::string_view bytes = fuzz::text_of(data, size);
  const std::string_view kind = fuzz::take_line(bytes);
  return fuzz::expect_result_or_input_error([&] { import_bytes(folder, kind, bytes); });
}
