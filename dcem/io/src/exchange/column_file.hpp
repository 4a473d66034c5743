#pragma once
/// Columns of numbers that grow, in an HDF5 file. Private to dcem::io.
///
/// The HDF Group, "HDF5 File Format Specification" (version 1.8 of the library and newer read it). The same columns
/// give the same bytes: no time is stored.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {

/// "HDF5 1.10.8". Only where there is one.
std::string column_library();

/// What values are in the file.
enum class ColumnType { float32, float64, uint8, uint32, uint64 };

/// All functions throw `OutputError`.
class ColumnFile {
 public:
  /// Into a file to which nothing was written yet; committing it is up to the caller.
  explicit ColumnFile(AtomicFile& file);
  ~ColumnFile();
  ColumnFile(const ColumnFile&) = delete;
  ColumnFile& operator=(const ColumnFile&) = delete;

  void add_group(const std::string& path);
  /// A list that is whole.
  void add_texts(const std::string& path, std::span<const std::string> texts);
  /// A column that has no value yet; returns its number.
  std::size_t open_column(const std::string& path, ColumnType type);
  void append(std::size_t column, std::span<const double> values);
  void append(std::size_t column, std::span<const std::uint64_t> values);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dcem::io
