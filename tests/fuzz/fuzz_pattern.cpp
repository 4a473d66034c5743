/// An antenna pattern: a table (first line "csv"), otherwise MSI or NSMA.
#include "dcem/io/antenna_files.hpp"
#include "tests/fuzz/fuzzed_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace dcem;
  static const fuzz::WorkFolder folder;
  std::string_view bytes = fuzz::text_of(data, size);
  const bool is_table = fuzz::take_line(bytes) == "csv";
  const auto file = folder.write(is_table ? "fuzzed.csv" : "fuzzed.msi", bytes);
  return fuzz::expect_result_or_input_error([&] {
    if (is_table) {
      io::read_pattern_csv(file);
    } else {
      io::read_msi(file);
    }
  });
}
