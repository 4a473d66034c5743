/// NPZ files, read back with libzip and a small reader of NPY.
#include "dcem/io/npz_writer.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <zip.h>

#include <array>
#include <bit>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <stdexcept>

#include "tests/io/temporary_folder.hpp"

namespace test_npz_writer {

using namespace dcem::io;
using dcem::test::file_bytes;
using dcem::test::TemporaryFolder;

namespace {

using Doubles = std::vector<double>;
using Texts = std::vector<std::string>;

/// An array as a reader finds it: what the header says, and the bytes behind it.
struct NpyArray {
  std::string type, shape, data;
};

/// The text between `before` and `after`.
std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t begin = text.find(before);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = text.find(after, begin + before.size());
  REQUIRE(end != std::string::npos);
  return text.substr(begin + before.size(), end - begin - before.size());
}

NpyArray parsed(const std::string& bytes) {
  REQUIRE(bytes.size() >= 10);
  REQUIRE(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  REQUIRE(bytes.size() >= 10 + length);
  CHECK((10 + length) % 64 == 0);
  const std::string header = bytes.substr(10, length);
  CHECK(header.back() == '\n');
  CHECK(between(header, "'fortran_order': ", ",") == "False");
  return {between(header, "'descr': '", "'"), between(header, "'shape': ", ", }"), bytes.substr(10 + length)};
}

struct ZipEntry {
  std::string name, bytes;
  zip_uint16_t method = 0;
};

/// Every entry, in its order; libzip compares the checksum of what it reads.
std::vector<ZipEntry> entries_of(const std::filesystem::path& path) {
  int error = 0;
  zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error);
  REQUIRE(archive != nullptr);
  std::vector<ZipEntry> entries;
  for (zip_int64_t index = 0; index < zip_get_num_entries(archive, 0); ++index) {
    zip_stat_t facts;
    REQUIRE(zip_stat_index(archive, static_cast<zip_uint64_t>(index), 0, &facts) == 0);
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(index), 0);
    REQUIRE(file != nullptr);
    std::string bytes(facts.size, '\0');
    CHECK(zip_fread(file, bytes.data(), facts.size) == static_cast<zip_int64_t>(facts.size));
    char more = 0;
    CHECK(zip_fread(file, &more, 1) == 0);
    CHECK(zip_fclose(file) == 0);
    entries.push_back({facts.name, std::move(bytes), facts.comp_method});
  }
  zip_discard(archive);
  return entries;
}

void write(const NpzWriter& writer, const std::filesystem::path& path) {
  AtomicFile file(path);
  writer.write(file);
  file.commit();
}

/// The only array of a file that holds one.
NpyArray read_back(const NpzWriter& writer) {
  const TemporaryFolder folder;
  write(writer, folder / "one.npz");
  CHECK(folder.names() == Texts{"one.npz"});
  const auto entries = entries_of(folder / "one.npz");
  REQUIRE(entries.size() == 1);
  CHECK(entries[0].name == "x.npy");
  return parsed(entries[0].bytes);
}

template <typename Values>
NpyArray read_back(const NpzWriter::Shape& shape, const Values& values) {
  NpzWriter writer;
  writer.add("x", shape, values);
  return read_back(writer);
}

template <typename Value>
std::vector<Value> values_of(const NpyArray& array) {
  REQUIRE(array.data.size() % sizeof(Value) == 0);
  std::vector<Value> values(array.data.size() / sizeof(Value));
  std::memcpy(values.data(), array.data.data(), array.data.size());
  return values;
}

NpzWriter several_arrays(NpzCompression compression = NpzCompression::none) {
  NpzWriter writer(compression);
  writer.add("tau", {2, 500}, Doubles(1000, -1.0));
  writer.add("valid", {3}, std::vector<bool>{true, false, true});
  writer.add("rx_id", {2}, Texts{"ue", "probe[0]"});
  return writer;
}

/// The time zone of the process, put back at the end.
class TimeZone {
 public:
  explicit TimeZone(const char* name) {
    if (const char* old = std::getenv("TZ")) old_ = old;
    set(name);
  }
  TimeZone(const TimeZone&) = delete;
  TimeZone& operator=(const TimeZone&) = delete;
  ~TimeZone() { set(old_.empty() ? nullptr : old_.c_str()); }

 private:
  static void set(const char* name) {
    name != nullptr ? ::setenv("TZ", name, 1) : ::unsetenv("TZ");
    ::tzset();
  }
  std::string old_;
};

}  // namespace

TEST_CASE("a small array begins with the 128 bytes that numpy.save writes") {
  NpzWriter writer;
  writer.add("x", {2, 3}, Doubles{1, 2, 3, 4, 5, 6});
  const TemporaryFolder folder;
  write(writer, folder / "one.npz");
  const std::string bytes = entries_of(folder / "one.npz").at(0).bytes;
  // 118 = 0x76 = 'v' bytes of header follow the length.
  const std::string start =
      std::string("\x93NUMPY\x01\x00v\x00", 10) + "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
  CHECK(bytes.substr(0, 128) == start + std::string(127 - start.size(), ' ') + "\n");
  CHECK(bytes.size() == 128 + 48);
}

TEST_CASE("doubles come back bit for bit") {
  const Doubles values{0.0, -0.0, 1.0 / 3.0, -1e300, 5e-324, std::numeric_limits<double>::infinity()};
  const NpyArray array = read_back({3, 2}, values);
  CHECK(array.type == "<f8");
  CHECK(array.shape == "(3, 2)");
  const Doubles back = values_of<double>(array);
  REQUIRE(back.size() == values.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    CHECK(std::bit_cast<std::uint64_t>(back[i]) == std::bit_cast<std::uint64_t>(values[i]));
  }
  // Little endian: the sign of −0.0 is in the last byte of eight.
  CHECK(array.data.substr(8, 8) == std::string("\0\0\0\0\0\0\0\x80", 8));
}

TEST_CASE("complex numbers, whole numbers and flags come back") {
  const std::vector<std::complex<double>> amplitudes{{1.5, -2.5}, {0.0, 1e-9}};
  const NpyArray complex = read_back({1, 2, 1}, amplitudes);
  CHECK(complex.type == "<c16");
  CHECK(complex.shape == "(1, 2, 1)");
  CHECK(values_of<double>(complex) == Doubles{1.5, -2.5, 0.0, 1e-9});

  const std::vector<std::uint32_t> kinds{0, 1, 2, 4, 8, 0x01020304u, 0xffffffffu};
  const NpyArray whole = read_back({7}, kinds);
  CHECK(whole.type == "<u4");
  CHECK(whole.shape == "(7,)");
  CHECK(values_of<std::uint32_t>(whole) == kinds);
  CHECK(whole.data.substr(20, 4) == "\x04\x03\x02\x01");

  const NpyArray flags = read_back({2, 2}, std::vector<bool>{true, false, false, true});
  CHECK(flags.type == "|b1");
  CHECK(flags.data == std::string("\x01\x00\x00\x01", 4));
}

TEST_CASE("texts are as wide as the longest of them, in characters, not in bytes") {
  const NpyArray array = read_back({2, 2}, Texts{"Straße", "", "\xF0\x9D\x84\x9E", "a\xE2\x82\xAC"});
  CHECK(array.type == "<U6");
  const auto characters = values_of<char32_t>(array);
  REQUIRE(characters.size() == 24);
  CHECK(std::u32string(characters.begin(), characters.begin() + 6) == U"Stra\u00DFe");
  CHECK(std::u32string(characters.begin() + 6, characters.begin() + 12) == std::u32string(6, U'\0'));
  CHECK(std::u32string(characters.begin() + 12, characters.begin() + 18) == U"\U0001D11E" + std::u32string(5, U'\0'));
  CHECK(std::u32string(characters.begin() + 18, characters.end()) == U"a\u20AC" + std::u32string(4, U'\0'));
  CHECK(read_back({2}, Texts{"", ""}).type == "<U1");
  CHECK(read_back({0}, Texts{}).type == "<U1");
}

TEST_CASE("texts that are not UTF-8 are refused") {
  NpzWriter writer;
  for (const std::string text : {"\xFF", "a\x80", "\xC3", "\xC3(", "\xC0\xAF", "\xE0\x80\x80", "\xED\xA0\x80",
                                 "\xF4\x90\x80\x80", "\xF0\x82\x82\xAC", "\xF8\x88\x80\x80\x80", "\xE2\x82"}) {
    CHECK_THROWS_AS(writer.add("x", {1}, Texts{text}), std::invalid_argument);
    CHECK_THROWS_AS(writer.add(text, {1}, Doubles{1.0}), std::invalid_argument);
  }
  writer.add("x", {1}, Texts{"\xED\x9F\xBF\xEE\x80\x80\xF4\x8F\xBF\xBF"});  // next to what is refused
}

TEST_CASE("a single value has no axis, an empty array has one of length 0") {
  const NpyArray single = read_back({}, Doubles{30e9});
  CHECK(single.shape == "()");
  CHECK(values_of<double>(single) == Doubles{30e9});
  CHECK(read_back({0}, Doubles{}).shape == "(0,)");
  CHECK(read_back({4, 0, 7}, Doubles{}).shape == "(4, 0, 7)");
  CHECK(read_back({4, 0, 7}, Doubles{}).data.empty());
  CHECK(read_back({1, 1, 1, 1, 1, 2}, Doubles{1, 2}).shape == "(1, 1, 1, 1, 1, 2)");
}

TEST_CASE("the arrays keep their order and their names") {
  const TemporaryFolder folder;
  write(several_arrays(), folder / "paths.npz");
  const auto entries = entries_of(folder / "paths.npz");
  REQUIRE(entries.size() == 3);
  CHECK(entries[0].name == "tau.npy");
  CHECK(entries[1].name == "valid.npy");
  CHECK(entries[2].name == "rx_id.npy");
  for (const ZipEntry& entry : entries) CHECK(entry.method == ZIP_CM_STORE);
  CHECK(parsed(entries[2].bytes).type == "<U8");
}

TEST_CASE("deflated files hold the same arrays in less space") {
  const TemporaryFolder folder;
  write(several_arrays(), folder / "stored.npz");
  write(several_arrays(NpzCompression::deflate), folder / "deflated.npz");
  const auto stored = entries_of(folder / "stored.npz"), deflated = entries_of(folder / "deflated.npz");
  REQUIRE(deflated.size() == stored.size());
  for (std::size_t i = 0; i < stored.size(); ++i) CHECK(deflated[i].bytes == stored[i].bytes);
  CHECK(deflated[0].method == ZIP_CM_DEFLATE);
  CHECK(file_bytes(folder / "deflated.npz").size() < file_bytes(folder / "stored.npz").size() / 4);
}

TEST_CASE("the same arrays give the same bytes, whenever and wherever the clock stands") {
  const TemporaryFolder folder;
  for (const NpzCompression compression : {NpzCompression::none, NpzCompression::deflate}) {
    std::vector<std::string> files;
    for (const char* zone : {"UTC", "Asia/Kathmandu", "XYZ+11", "XYZ-13"}) {
      const TimeZone there(zone);
      write(several_arrays(compression), folder / "again.npz");
      files.push_back(file_bytes(folder / "again.npz"));
    }
    for (const std::string& file : files) CHECK(file == files.front());
    // Bytes 10 to 13 of the first entry: 12:00:00 on 1980-01-01, in the bits of MS-DOS.
    CHECK(files.front().substr(10, 4) == std::string("\x00\x60\x21\x00", 4));
  }
}

TEST_CASE("names and shapes that do not fit are refused, and what was added before stays") {
  NpzWriter writer;
  const Doubles six(6, 1.0);
  writer.add("x", {6}, six);
  for (const std::string& name : {std::string(), std::string("a/b"), std::string("a\0b", 3), std::string("x")}) {
    CHECK_THROWS_AS(writer.add(name, {6}, six), std::invalid_argument);
  }
  const std::size_t huge = std::size_t{1} << 33;
  for (const NpzWriter::Shape& shape : {NpzWriter::Shape{}, {5}, {7}, {2, 2}, {6, 0}, {huge, huge}, {huge, huge, 6}}) {
    CHECK_THROWS_AS(writer.add("y", shape, six), std::invalid_argument);
  }
  CHECK_THROWS_AS(writer.add("y", NpzWriter::Shape(30'000, 1), Doubles{1.0}), std::invalid_argument);
  CHECK(values_of<double>(read_back(writer)) == six);
}

TEST_CASE("without an array there is nothing to write") {
  const TemporaryFolder folder;
  AtomicFile file(folder / "empty.npz");
  CHECK_THROWS_AS(NpzWriter().write(file), std::logic_error);
}

TEST_CASE("a writer can write twice") {
  const TemporaryFolder folder;
  const NpzWriter writer = several_arrays();
  write(writer, folder / "a.npz");
  write(writer, folder / "b.npz");
  CHECK(file_bytes(folder / "a.npz") == file_bytes(folder / "b.npz"));
}

TEST_CASE("a disk that takes no more is an error with the file's name, and nothing stays") {
  const TemporaryFolder folder;
  NpzWriter writer;
  writer.add("x", {200'000}, Doubles(200'000, 1.5));
  auto* const old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  rlimit limit = old_limit;
  limit.rlim_cur = 100'000;
  setrlimit(RLIMIT_FSIZE, &limit);
  std::string message = "nothing was thrown";
  try {
    write(writer, folder / "large.npz");
  } catch (const OutputError& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  CHECK(message.starts_with((folder / "large.npz").string() + ": "));
  CHECK(message.find("; expected ") != std::string::npos);
  CHECK(folder.names().empty());
}

}  // namespace test_npz_writer
