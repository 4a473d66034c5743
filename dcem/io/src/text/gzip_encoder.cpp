#include "dcem/io/src/text/gzip_encoder.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>
#include <vector>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {
namespace {

constexpr int gzip_window_bits = 15 + 16;  // the largest window; 16 more stand for the format gzip
constexpr int usual_memory_level = 8;
constexpr int unknown_system = 255;
constexpr std::size_t block_bytes = std::size_t{1} << 16;

}  // namespace

GzipEncoder::GzipEncoder(AtomicFile& file) : file_(file), stream_(std::make_unique<z_stream>()) {
  if (deflateInit2(stream_.get(), Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_window_bits, usual_memory_level,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  static gz_header header = [] {
    gz_header plain{};
    plain.os = unknown_system;
    return plain;
  }();
  deflateSetHeader(stream_.get(), &header);
}

GzipEncoder::~GzipEncoder() {
  deflateEnd(stream_.get());
}

void GzipEncoder::write(std::string_view bytes) {
  constexpr std::size_t most = std::numeric_limits<uInt>::max();  // that zlib can count
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), most))) {
    deflate_all(bytes.substr(0, most), Z_NO_FLUSH);
  }
}

void GzipEncoder::finish() {
  deflate_all({}, Z_FINISH);
}

void GzipEncoder::deflate_all(std::string_view bytes, int flush) {
  std::vector<char> block(block_bytes);
  stream_->next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream_->avail_in = static_cast<uInt>(bytes.size());
  do {
    stream_->next_out = reinterpret_cast<Bytef*>(block.data());
    stream_->avail_out = static_cast<uInt>(block.size());
    deflate(stream_.get(), flush);
    file_.write({block.data(), block.size() - stream_->avail_out});
  } while (stream_->avail_out == 0);
}

}  // namespace dcem::io
