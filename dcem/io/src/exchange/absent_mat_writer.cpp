// In place of matio_mat_writer.cpp where there is no matio.
#include <stdexcept>

#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/src/exchange/mat_writer.hpp"

namespace dcem::io {

namespace {

[[noreturn]] void refuse_mat() {
  throw std::logic_error(std::string(no_mat) + "; expected " + std::string(mat_expected));
}

}  // namespace

struct MatWriter::State {};

bool can_write_mat() {
  return false;
}

std::string mat_library() {
  refuse_mat();
}

MatWriter::MatWriter(AtomicFile&) {
  refuse_mat();
}

MatWriter::~MatWriter() = default;

void MatWriter::add(const std::string&, const Shape&, std::span<const double>) {
  refuse_mat();
}

void MatWriter::add(const std::string&, const Shape&, std::span<const std::complex<double>>) {
  refuse_mat();
}

void MatWriter::add(const std::string&, const Shape&, std::span<const std::uint32_t>) {
  refuse_mat();
}

void MatWriter::add(const std::string&, const Shape&, const std::vector<bool>&) {
  refuse_mat();
}

void MatWriter::add(const std::string&, const Shape&, std::span<const std::string>) {
  refuse_mat();
}

void MatWriter::finish() {
  refuse_mat();
}

}  // namespace dcem::io
