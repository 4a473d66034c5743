/// A trace, types of vehicles, or poses, as the first line says (fcd, types, poses), in an otherwise good scenario,
/// with its frames.
#include <algorithm>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/scenario.hpp"
#include "tests/fuzz/fuzzed_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dcem;
  static const fuzz::WorkFolder folder;
  const std::filesystem::path good = std::filesystem::path(DCEM_SOURCE_DIR) / "tests/invalid_input";
  folder.copy_from(good / "good");
  folder.copy_from(good / "good_traffic");
  std::ifstream original(good / "good_traffic/scenario.json");
  std::string scenario((std::istreambuf_iterator<char>(original)), {});
  const std::string up = "../good/";
  scenario.erase(scenario.find(up), up.size());
  std::string_view bytes = fuzz::text_of(data, size);
  const std::string_view kind = fuzz::take_line(bytes);
  folder.write(kind == "poses" ? "poses.csv" : kind == "types" ? "vtypes.add.xml" : "trace.fcd.xml", bytes);
  const auto file = folder.write("fuzzed.json", scenario);
  return fuzz::expect_result_or_input_error([&] {
    const io::Scenario read = io::load_scenario(file);
    io::FrameSource frames(read);
    constexpr std::size_t most_frames = 20;
    for (std::size_t frame = 0; frame < std::min(most_frames, read.time.frames); ++frame) {
      (void)frames.frame(read.scene, frame);
    }
  });
}
