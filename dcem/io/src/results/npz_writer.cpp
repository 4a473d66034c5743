#include "dcem/io/npz_writer.hpp"

#include <zip.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <limits>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "dcem/io/src/text/unicode.hpp"

namespace dcem::io {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");
static_assert(sizeof(std::complex<double>) == 16 && sizeof(double) == 8);

// 1980-01-01 12:00:00 in the two words of a ZIP entry: noon, because libzip turns it into local time and back, and
// midnight may be missing from a day.
constexpr zip_uint16_t entry_date = (1u << 5) | 1u;
constexpr zip_uint16_t entry_time = 12u << 11;

std::size_t value_count(const NpzWriter::Shape& shape) {
  if (std::find(shape.begin(), shape.end(), 0u) != shape.end()) return 0;
  std::size_t count = 1;
  for (const std::size_t length : shape) {
    if (length > std::numeric_limits<std::size_t>::max() / count) throw std::invalid_argument("NPZ: shape too large");
    count *= length;
  }
  return count;
}

// (), (3,), (3, 4): a Python tuple.
std::string shape_text(const NpzWriter::Shape& shape) {
  std::string text = "(";
  for (std::size_t axis = 0; axis < shape.size(); ++axis) {
    if (axis > 0) text += ' ';
    text += std::to_string(shape[axis]);
    if (axis + 1 < shape.size() || axis == 0) text += ',';
  }
  return text + ")";
}

// Magic, version 1.0, length, a Python dictionary, padded so that the values begin at a multiple of 64 bytes.
std::string npy_header(const std::string& type, const NpzWriter::Shape& shape) {
  constexpr std::size_t prefix_bytes = 10, alignment_bytes = 64;
  std::string dictionary = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape_text(shape) + ", }";
  while ((prefix_bytes + dictionary.size() + 1) % alignment_bytes != 0) dictionary += ' ';
  dictionary += '\n';
  if (dictionary.size() > 0xffff) throw std::invalid_argument("NPZ: too many dimensions");
  std::string header = "\x93NUMPY";
  header += '\x01';
  header += '\x00';
  header += static_cast<char>(dictionary.size() & 0xff);
  header += static_cast<char>(dictionary.size() >> 8);
  return header + dictionary;
}

// What libzip writes goes into a stream. The archive is new, so nothing is ever read.
class ZipTarget {
 public:
  explicit ZipTarget(std::ostream& stream) : stream_(stream) { zip_error_init(&error_); }
  ZipTarget(const ZipTarget&) = delete;
  ZipTarget& operator=(const ZipTarget&) = delete;
  ~ZipTarget() { zip_error_fini(&error_); }

  static zip_int64_t call(void* target, void* data, zip_uint64_t length, zip_source_cmd_t command) {
    return static_cast<ZipTarget*>(target)->handle(data, length, command);
  }

 private:
  zip_int64_t handle(void* data, zip_uint64_t length, zip_source_cmd_t command) {
    switch (command) {
      case ZIP_SOURCE_SUPPORTS:
        return ZIP_SOURCE_SUPPORTS_WRITABLE;
      case ZIP_SOURCE_STAT:
        return fail(ZIP_ER_READ, ENOENT);  // this is how libzip asks whether there is an old archive
      case ZIP_SOURCE_ERROR:
        return zip_error_to_data(&error_, data, length);
      case ZIP_SOURCE_WRITE:
        return write(data, length);
      case ZIP_SOURCE_SEEK_WRITE:
        return seek(data, length);
      case ZIP_SOURCE_TELL_WRITE:
        return static_cast<zip_int64_t>(position_);
      case ZIP_SOURCE_BEGIN_WRITE:
      case ZIP_SOURCE_COMMIT_WRITE:
      case ZIP_SOURCE_ROLLBACK_WRITE:
      case ZIP_SOURCE_REMOVE:
      case ZIP_SOURCE_FREE:
        return 0;
      default:
        return fail(ZIP_ER_OPNOTSUPP, 0);
    }
  }

  zip_int64_t write(const void* data, zip_uint64_t length) {
    if (!stream_.write(static_cast<const char*>(data), static_cast<std::streamsize>(length))) {
      return fail(ZIP_ER_WRITE, errno);
    }
    position_ += length;
    end_ = std::max(end_, position_);
    return static_cast<zip_int64_t>(length);
  }

  zip_int64_t seek(void* data, zip_uint64_t length) {
    const zip_int64_t offset = zip_source_seek_compute_offset(position_, end_, data, length, &error_);
    if (offset < 0) return -1;
    if (!stream_.seekp(static_cast<std::streamoff>(offset))) return fail(ZIP_ER_SEEK, errno);
    position_ = static_cast<zip_uint64_t>(offset);
    return 0;
  }

  zip_int64_t fail(int zip_error, int system_error) {
    zip_error_set(&error_, zip_error, system_error);
    return -1;
  }

  std::ostream& stream_;
  zip_error_t error_;
  zip_uint64_t position_ = 0, end_ = 0;
};

// A new archive in a stream. What fails throws std::runtime_error with libzip's text.
class ZipArchive {
 public:
  explicit ZipArchive(std::ostream& stream) : target_(stream) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_function_create(&ZipTarget::call, &target_, &error);
    if (source != nullptr) archive_.reset(zip_open_from_source(source, ZIP_CREATE | ZIP_TRUNCATE, &error));
    const std::string text = archive_ ? "" : zip_error_strerror(&error);
    zip_error_fini(&error);
    if (archive_) return;
    zip_source_free(source);
    throw std::runtime_error(text);
  }

  // `bytes` must stay until `close`.
  void add(const std::string& name, const std::string& bytes, zip_int32_t method) {
    zip_source_t* source = zip_source_buffer(archive_.get(), bytes.data(), bytes.size(), 0);
    check(source != nullptr);
    const zip_int64_t index = zip_file_add(archive_.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) zip_source_free(source);
    check(index >= 0);
    const auto entry = static_cast<zip_uint64_t>(index);
    check(zip_set_file_compression(archive_.get(), entry, method, 0) == 0);
    check(zip_file_set_dostime(archive_.get(), entry, entry_time, entry_date, 0) == 0);
  }

  void close() {
    check(zip_close(archive_.get()) == 0);
    static_cast<void>(archive_.release());  // freed by zip_close where it succeeds
  }

 private:
  void check(bool succeeded) const {
    if (!succeeded) throw std::runtime_error(zip_strerror(archive_.get()));
  }

  ZipTarget target_;  // outlives the archive
  std::unique_ptr<zip_t, decltype(&zip_discard)> archive_{nullptr, &zip_discard};
};

}  // namespace

void NpzWriter::add(const std::string& name, const Shape& shape, std::span<const double> values) {
  add_bytes(name, shape, values.size(), "<f8", values.data(), values.size_bytes());
}

void NpzWriter::add(const std::string& name, const Shape& shape, std::span<const std::complex<double>> values) {
  add_bytes(name, shape, values.size(), "<c16", values.data(), values.size_bytes());
}

void NpzWriter::add(const std::string& name, const Shape& shape, std::span<const std::uint32_t> values) {
  add_bytes(name, shape, values.size(), "<u4", values.data(), values.size_bytes());
}

void NpzWriter::add(const std::string& name, const Shape& shape, const std::vector<bool>& values) {
  std::string bytes;
  for (const bool value : values) bytes += value ? '\x01' : '\x00';
  add_bytes(name, shape, values.size(), "|b1", bytes.data(), bytes.size());
}

void NpzWriter::add(const std::string& name, const Shape& shape, std::span<const std::string> texts) {
  std::vector<std::u32string> rows;
  std::size_t width = 1;  // as NumPy, which knows no text without room for a character
  for (const std::string& text : texts) {
    rows.push_back(decoded(text));
    width = std::max(width, rows.back().size());
  }
  std::u32string characters;
  for (std::u32string& row : rows) {
    row.resize(width, U'\0');
    characters += row;
  }
  const std::size_t size_bytes = characters.size() * sizeof(char32_t);
  add_bytes(name, shape, texts.size(), "<U" + std::to_string(width), characters.data(), size_bytes);
}

void NpzWriter::add_bytes(const std::string& name, const Shape& shape, std::size_t count, const std::string& type,
                          const void* values, std::size_t size_bytes) {
  const bool used = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& one) { return one.name == name; });
  if (name.empty() || used || name.find_first_of(std::string_view("/\0", 2)) != std::string::npos) {
    throw std::invalid_argument("NPZ: '" + name + "' is no name for an array, or was used before");
  }
  decoded(name);  // throws where it is not UTF-8, as a name in a ZIP archive has to be
  if (value_count(shape) != count) throw std::invalid_argument("NPZ: the shape of '" + name + "' does not fit");
  std::string bytes = npy_header(type, shape);
  if (size_bytes > 0) bytes.append(static_cast<const char*>(values), size_bytes);
  entries_.push_back({name, std::move(bytes)});
}

void NpzWriter::write(AtomicFile& file) const {
  if (entries_.empty()) throw std::logic_error("NPZ: no array to write");
  try {
    ZipArchive archive(file.stream());
    const zip_int32_t method = compression_ == NpzCompression::none ? ZIP_CM_STORE : ZIP_CM_DEFLATE;
    for (const Entry& entry : entries_) archive.add(entry.name + ".npy", entry.bytes, method);
    archive.close();
  } catch (const std::runtime_error& error) {
    file.close();  // throws, with the reason, where the disk took no more
    throw OutputError(file.target(), "could not be packed (" + std::string(error.what()) + ")", "a ZIP archive");
  }
}

}  // namespace dcem::io
