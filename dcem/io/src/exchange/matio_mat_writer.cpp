// MAT files with matio. Compiled only where matio is.
#include <matio.h>

#include <array>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/src/exchange/mat_writer.hpp"
#include "dcem/io/src/text/unicode.hpp"

namespace dcem::io {
namespace {

using Shape = MatWriter::Shape;
using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;

Shape with_two_axes(Shape shape) {
  while (shape.size() < 2) shape.push_back(1);
  return shape;
}

/// Calls put(place) for each value of an array in C order, with its place in the order of MATLAB.
template <typename Put>
void each_place(const Shape& shape, std::size_t count, Put&& put) {
  Shape index(shape.size(), 0), stride(shape.size(), 1);
  for (std::size_t axis = 1; axis < shape.size(); ++axis) stride[axis] = stride[axis - 1] * shape[axis - 1];
  std::size_t place = 0;
  for (std::size_t i = 0; i < count; ++i) {
    put(i, place);
    for (std::size_t axis = shape.size(); axis-- > 0;) {
      place += stride[axis];
      if (++index[axis] < shape[axis]) break;
      place -= stride[axis] * shape[axis];
      index[axis] = 0;
    }
  }
}

template <typename To, typename Values, typename Pick>
std::vector<To> turned(const Shape& shape, const Values& values, Pick&& pick) {
  std::vector<To> result(values.size());
  each_place(shape, values.size(), [&](std::size_t i, std::size_t place) { result[place] = pick(values[i]); });
  return result;
}

Variable text_cell(const std::string& text) {
  std::u16string units = utf16(text);
  std::array<std::size_t, 2> axes{1, units.size()};
  return {Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF16, 2, axes.data(), units.data(), 0), &Mat_VarFree};
}

}  // namespace

struct MatWriter::State {
  explicit State(AtomicFile& out) : file(out) {}

  void check(bool succeeded) {
    if (succeeded) return;
    throw OutputError(file.target(), "could not be written to its end",
                      "a folder that can be written, with space left");
  }

  void write(const std::string& name, const Shape& shape, matio_classes kind, matio_types type, void* values,
             int flags = 0) {
    Shape axes = with_two_axes(shape);
    const Variable variable(Mat_VarCreate(name.c_str(), kind, type, static_cast<int>(axes.size()), axes.data(), values,
                                          flags | MAT_F_DONT_COPY_DATA),
                            &Mat_VarFree);
    write(*variable);
  }

  void write(matvar_t& variable) {
    check(Mat_VarWrite(mat.get(), &variable, MAT_COMPRESSION_ZLIB) == 0);
    names.emplace_back(variable.name);
  }

  AtomicFile& file;
  File mat{nullptr, &Mat_Close};
  std::vector<std::string> names;
};

bool can_write_mat() {
  return true;
}

std::string mat_library() {
  int major = 0, minor = 0, release = 0;
  Mat_GetLibraryVersion(&major, &minor, &release);
  return "matio " + std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
}

MatWriter::MatWriter(AtomicFile& file) : state_(std::make_unique<State>(file)) {
  constexpr const char* header = "MATLAB 5.0 MAT-file, paths of DCEM";
  state_->mat.reset(Mat_CreateVer(file.aside().c_str(), header, MAT_FT_MAT5));
  state_->check(state_->mat != nullptr);
}

MatWriter::~MatWriter() = default;

void MatWriter::add(const std::string& name, const Shape& shape, std::span<const double> values) {
  auto columns = turned<double>(shape, values, [](double value) { return value; });
  state_->write(name, shape, MAT_C_DOUBLE, MAT_T_DOUBLE, columns.data());
}

void MatWriter::add(const std::string& name, const Shape& shape, std::span<const std::complex<double>> values) {
  using Complex64 = std::complex<double>;
  auto real = turned<double>(shape, values, [](const Complex64& value) { return value.real(); });
  auto imaginary = turned<double>(shape, values, [](const Complex64& value) { return value.imag(); });
  mat_complex_split_t both{real.data(), imaginary.data()};
  state_->write(name, shape, MAT_C_DOUBLE, MAT_T_DOUBLE, &both, MAT_F_COMPLEX);
}

void MatWriter::add(const std::string& name, const Shape& shape, std::span<const std::uint32_t> values) {
  auto columns = turned<std::uint32_t>(shape, values, [](std::uint32_t value) { return value; });
  state_->write(name, shape, MAT_C_UINT32, MAT_T_UINT32, columns.data());
}

void MatWriter::add(const std::string& name, const Shape& shape, const std::vector<bool>& values) {
  auto columns = turned<std::uint8_t>(shape, values, [](bool value) { return static_cast<std::uint8_t>(value); });
  state_->write(name, shape, MAT_C_UINT8, MAT_T_UINT8, columns.data(), MAT_F_LOGICAL);
}

void MatWriter::add(const std::string& name, const Shape& shape, std::span<const std::string> texts) {
  std::vector<Variable> owners;
  for (const std::string& text : texts) owners.push_back(text_cell(text));
  std::vector<matvar_t*> cells;
  for (Variable& owner : owners) cells.push_back(owner.release());  // the array of cells frees them
  Shape axes = with_two_axes(shape);
  const Variable list(
      Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, static_cast<int>(axes.size()), axes.data(), cells.data(), 0),
      &Mat_VarFree);
  state_->write(*list);
}

void MatWriter::finish() {
  State& state = *state_;
  state.mat.reset();
  const File written(Mat_Open(state.file.aside().c_str(), MAT_ACC_RDONLY), &Mat_Close);
  state.check(written != nullptr);
  for (const std::string& name : state.names) {
    const Variable variable(Mat_VarReadNextInfo(written.get()), &Mat_VarFree);
    state.check(variable != nullptr && name == variable->name);
    if (name == state.names.back()) state.check(Mat_VarReadDataAll(written.get(), variable.get()) == 0);
  }
}

}  // namespace dcem::io
