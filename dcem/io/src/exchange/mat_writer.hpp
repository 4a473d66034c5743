#pragma once
/// Arrays for MATLAB and Octave: a MAT file of level 5, compressed. Private to dcem::io.
///
/// Written with matio (github.com/tbeu/matio); the format is in "MAT-File Format", The MathWorks. An array has at most
/// 2³¹ − 1 bytes there. MATLAB knows no arrays of fewer than two axes: a single value is 1×1, a list of n is n×1, texts
/// are a cell array. The same arrays in the same order give the same bytes: the header has no date.
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {

/// "matio 1.5.23". Only where there is one.
std::string mat_library();

/// What one array of a MAT file may take.
inline constexpr double most_mat_array_bytes = 2147483647.0;

/// Writes array after array, each with the signature that `NpzWriter` has for it: values come in C order, the last
/// index fastest, and are turned into the order of MATLAB, where the first one is; indices mean the same in both.
/// Functions throw `OutputError`, and std::invalid_argument where a text is not UTF-8.
class MatWriter {
 public:
  using Shape = std::vector<std::size_t>;

  /// Into a file to which nothing was written yet; committing it is up to the caller.
  explicit MatWriter(AtomicFile& file);
  ~MatWriter();
  MatWriter(const MatWriter&) = delete;
  MatWriter& operator=(const MatWriter&) = delete;

  void add(const std::string& name, const Shape& shape, std::span<const double> values);
  void add(const std::string& name, const Shape& shape, std::span<const std::complex<double>> values);
  void add(const std::string& name, const Shape& shape, std::span<const std::uint32_t> values);
  void add(const std::string& name, const Shape& shape, const std::vector<bool>& values);  ///< logical
  void add(const std::string& name, const Shape& shape, std::span<const std::string> texts);
  /// After the last array: closes the file, and reads it through, because matio does not notice a full disk.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dcem::io
