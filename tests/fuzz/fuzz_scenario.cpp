/// A scenario beside good files of every kind.
#include "dcem/io/scenario.hpp"
#include "tests/fuzz/fuzzed_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dcem;
  static const fuzz::WorkFolder folder;
  static const bool prepared = [] {
    for (const char* name : {"good", "good_antenna", "good_traffic"}) {
      folder.copy_from(std::filesystem::path(DCEM_SOURCE_DIR) / "tests/invalid_input" / name);
    }
    return true;
  }();
  (void)prepared;
  const auto file = folder.write("fuzzed.json", fuzz::text_of(data, size));
  return fuzz::expect_result_or_input_error([&] { io::load_scenario(file); });
}
