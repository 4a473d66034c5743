// In place of hdf5_column_file.cpp where there is no HDF5.
#include <stdexcept>

#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/src/exchange/column_file.hpp"

namespace dcem::io {

namespace {

[[noreturn]] void refuse_columns() {
  throw std::logic_error(std::string(no_hdf5) + "; expected " + std::string(hdf5_expected));
}

}  // namespace

struct ColumnFile::State {};

bool can_write_hdf5() {
  return false;
}

std::string column_library() {
  refuse_columns();
}

ColumnFile::ColumnFile(AtomicFile&) {
  refuse_columns();
}

ColumnFile::~ColumnFile() = default;

void ColumnFile::add_group(const std::string&) {
  refuse_columns();
}

void ColumnFile::add_texts(const std::string&, std::span<const std::string>) {
  refuse_columns();
}

std::size_t ColumnFile::open_column(const std::string&, ColumnType) {
  refuse_columns();
}

void ColumnFile::append(std::size_t, std::span<const double>) {
  refuse_columns();
}

void ColumnFile::append(std::size_t, std::span<const std::uint64_t>) {
  refuse_columns();
}

void ColumnFile::close() {
  refuse_columns();
}

}  // namespace dcem::io
