/// An OBJ file, and behind a line "MTL" the material file that it may name as room.mtl.
#include "dcem/io/inspection.hpp"
#include "tests/fuzz/fuzzed_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dcem;
  static const fuzz::WorkFolder folder;
  const std::string_view bytes = fuzz::text_of(data, size);
  const std::size_t cut = bytes.find("\nMTL\n");
  folder.write("room.mtl", cut == std::string_view::npos ? std::string_view{} : bytes.substr(cut + 5));
  const auto file = folder.write("room.obj", bytes.substr(0, cut));
  return fuzz::expect_result_or_input_error([&] { io::inspect_obj(file); });
}
