// Columns with HDF5. Compiled only where HDF5 is.
#include <hdf5.h>

#include <array>
#include <utility>

#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/src/exchange/column_file.hpp"

namespace dcem::io {
namespace {

constexpr hsize_t rows_per_chunk = 8192;

hid_t file_type(ColumnType type) {
  switch (type) {
    case ColumnType::float32:
      return H5T_IEEE_F32LE;
    case ColumnType::float64:
      return H5T_IEEE_F64LE;
    case ColumnType::uint8:
      return H5T_STD_U8LE;
    case ColumnType::uint32:
      return H5T_STD_U32LE;
    case ColumnType::uint64:
      break;
  }
  return H5T_STD_U64LE;
}

}  // namespace

struct ColumnFile::State {
  /// Something of the library that has to be closed.
  class Handle {
   public:
    Handle() = default;
    Handle(hid_t id, herr_t (*closer)(hid_t)) : id_(id), close_(closer) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
      std::swap(id_, other.id_);
      std::swap(close_, other.close_);
      return *this;
    }
    ~Handle() {
      if (id_ >= 0) close_(id_);
    }

    hid_t id() const { return id_; }
    bool close() { return close_(std::exchange(id_, -1)) >= 0; }

   private:
    hid_t id_ = -1;
    herr_t (*close_)(hid_t) = nullptr;
  };

  struct Column {
    Handle data;
    hsize_t rows = 0;
  };

  explicit State(AtomicFile& out) : target(out) {}

  /// The library says no more than that something failed; it nearly always is the disk.
  void check(bool succeeded) const {
    if (succeeded) return;
    throw OutputError(target.target(), "could not be written to its end",
                      "a folder that can be written, with space left");
  }
  Handle checked(hid_t id, herr_t (*closer)(hid_t)) const {
    check(id >= 0);
    return {id, closer};
  }
  /// Settings of something new, without the time at which it was made.
  Handle timeless(hid_t kind) const {
    Handle settings = checked(H5Pcreate(kind), H5Pclose);
    check(H5Pset_obj_track_times(settings.id(), false) >= 0);
    return settings;
  }

  void append(std::size_t number, const void* values, hsize_t count, hid_t memory_type) {
    if (count == 0) return;
    Column& column = columns[number];
    const hsize_t first = column.rows, all = column.rows + count;
    check(H5Dset_extent(column.data.id(), &all) >= 0);
    const Handle place = checked(H5Dget_space(column.data.id()), H5Sclose);
    check(H5Sselect_hyperslab(place.id(), H5S_SELECT_SET, &first, nullptr, &count, nullptr) >= 0);
    const Handle memory = checked(H5Screate_simple(1, &count, nullptr), H5Sclose);
    check(H5Dwrite(column.data.id(), memory_type, memory.id(), place.id(), H5P_DEFAULT, values) >= 0);
    column.rows = all;
  }

  AtomicFile& target;
  Handle file;
  std::vector<Column> columns;
};

bool can_write_hdf5() {
  return true;
}

std::string column_library() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return "HDF5 " + std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
}

ColumnFile::ColumnFile(AtomicFile& file) : state_(std::make_unique<State>(file)) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are told by DCEM, once
  const State::Handle settings = state_->timeless(H5P_FILE_CREATE);
  state_->file = state_->checked(H5Fcreate(file.aside().c_str(), H5F_ACC_TRUNC, settings.id(), H5P_DEFAULT), H5Fclose);
}

ColumnFile::~ColumnFile() = default;

void ColumnFile::add_group(const std::string& path) {
  const State::Handle settings = state_->timeless(H5P_GROUP_CREATE);
  state_->checked(H5Gcreate2(state_->file.id(), path.c_str(), H5P_DEFAULT, settings.id(), H5P_DEFAULT), H5Gclose);
}

void ColumnFile::add_texts(const std::string& path, std::span<const std::string> texts) {
  const State::Handle type = state_->checked(H5Tcopy(H5T_C_S1), H5Tclose);
  state_->check(H5Tset_size(type.id(), H5T_VARIABLE) >= 0 && H5Tset_cset(type.id(), H5T_CSET_UTF8) >= 0);
  const hsize_t count = texts.size();
  const State::Handle space = state_->checked(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const State::Handle settings = state_->timeless(H5P_DATASET_CREATE);
  const State::Handle data = state_->checked(
      H5Dcreate2(state_->file.id(), path.c_str(), type.id(), space.id(), H5P_DEFAULT, settings.id(), H5P_DEFAULT),
      H5Dclose);
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  state_->check(H5Dwrite(data.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()) >= 0);
}

std::size_t ColumnFile::open_column(const std::string& path, ColumnType type) {
  const hsize_t none = 0, any = H5S_UNLIMITED;
  const State::Handle space = state_->checked(H5Screate_simple(1, &none, &any), H5Sclose);
  const State::Handle settings = state_->timeless(H5P_DATASET_CREATE);
  state_->check(H5Pset_chunk(settings.id(), 1, &rows_per_chunk) >= 0);
  state_->columns.push_back({state_->checked(
      H5Dcreate2(state_->file.id(), path.c_str(), file_type(type), space.id(), H5P_DEFAULT, settings.id(), H5P_DEFAULT),
      H5Dclose)});
  return state_->columns.size() - 1;
}

void ColumnFile::append(std::size_t column, std::span<const double> values) {
  state_->append(column, values.data(), values.size(), H5T_NATIVE_DOUBLE);
}

void ColumnFile::append(std::size_t column, std::span<const std::uint64_t> values) {
  state_->append(column, values.data(), values.size(), H5T_NATIVE_UINT64);
}

void ColumnFile::close() {
  for (State::Column& column : state_->columns) state_->check(column.data.close());
  state_->check(H5Fflush(state_->file.id(), H5F_SCOPE_GLOBAL) >= 0);
  state_->check(state_->file.close());
}

}  // namespace dcem::io
