#pragma once
/// Arrays for NumPy: an NPZ file is a ZIP archive with one NPY file per array. numpy.load("paths.npz")["tau"] reads
/// one.
///
/// NPY 1.0 (numpy.lib.format), little endian, C order: the last index runs fastest. The same arrays, added in the same
/// order, give the same bytes: every entry has one fixed time stamp.
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {

enum class NpzCompression {
  none,    ///< as numpy.savez
  deflate  ///< as numpy.savez_compressed; pays for arrays that are padded. The bytes depend on the version of zlib too.
};

/// Collects arrays and writes them. Each `add` copies; every one of them throws std::invalid_argument where the name is
/// empty, was used before or holds '/' or '\0', and where the product of `shape` is not the number of values. An empty
/// shape is a single value.
class NpzWriter {
 public:
  using Shape = std::vector<std::size_t>;

  explicit NpzWriter(NpzCompression compression = NpzCompression::none) : compression_(compression) {}

  void add(const std::string& name, const Shape& shape, std::span<const double> values);                ///< `<f8`
  void add(const std::string& name, const Shape& shape, std::span<const std::complex<double>> values);  ///< `<c16`
  void add(const std::string& name, const Shape& shape, std::span<const std::uint32_t> values);         ///< `<u4`
  void add(const std::string& name, const Shape& shape, const std::vector<bool>& values);               ///< `|b1`
  /// `<U…`, as wide as the longest text. The texts are UTF-8; throws std::invalid_argument where one is not. NumPy
  /// drops trailing '\0'.
  void add(const std::string& name, const Shape& shape, std::span<const std::string> texts);

  /// Writes the archive into an open file to which nothing was written yet; committing it is up to the caller. Throws
  /// `OutputError`, and std::logic_error where there is no array: a ZIP archive without entries is not written.
  void write(AtomicFile& file) const;

 private:
  struct Entry {
    std::string name, bytes;
  };

  void add_bytes(const std::string& name, const Shape& shape, std::size_t count, const std::string& type,
                 const void* values, std::size_t size_bytes);

  NpzCompression compression_;
  std::vector<Entry> entries_;
};

}  // namespace dcem::io
