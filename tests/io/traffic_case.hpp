#pragma once
/// A scenario with traffic in a temporary folder: a ground of one square, a trace, and whatever a test adds.
#include <string>

#include "dcem/io/frame_source.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/io/trace_files.hpp"

namespace dcem::test {

struct TrafficCase {
  TemporaryFolder folder;
  std::string trace_lines;
  std::string types = R"(<vType id="car" length="4" width="2" height="1.5"/>
<vType id="bus" length="10" width="2.5" height="3"/>)";
  /// Empty: no traffic.
  std::string mobility = R"({"sumo_fcd": "trace.xml", "vehicle_types": "types.xml", "material": "metal"})";
  std::string objects = "";
  std::string receivers = R"({"id": "rx", "position_m": [5, 0, 1]})";
  std::string more = "";  ///< further blocks, each with a comma before it

  void write_scenario() const {
    write_text(folder / "ground.obj",
               "mtllib ground.mtl\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nusemtl metal\nf 1 2 3 4\n");
    write_text(folder / "ground.mtl", "newmtl metal\n");
    write_text(folder / "types.xml", "<additional>\n" + types + "</additional>");
    write_text(folder / "case.json",
               R"({"format": "dcem-scenario/1", "frequency_hz": 30e9, "scene": {"obj": "ground.obj"},)"
               R"("materials": {"metal": {"model": "pec"}},)"
               R"("transmitters": [{"id": "tx", "position_m": [0, 0, 10], "power_dbm": 30}],)"
               "\n" +
                   (mobility.empty() ? "" : "\"mobility\": " + mobility + ",") + "\n\"objects\": [" + objects +
                   "],\n\"receivers\": [" + receivers + "]" + more + "}");
  }
  io::Scenario load() const {
    write_text(folder / "trace.xml", trace(trace_lines));
    write_scenario();
    return io::load_scenario(folder / "case.json");
  }
  std::string error() const {
    return input_error_of([&] { load(); });
  }
};

}  // namespace dcem::test
