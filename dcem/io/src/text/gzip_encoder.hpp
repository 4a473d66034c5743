#pragma once
/// A file that is compressed while it is written. Private to dcem::io.
#include <memory>
#include <string_view>

struct z_stream_s;

namespace dcem::io {

class AtomicFile;

/// Compresses what comes piece by piece; no more is held than zlib's window. The header has neither a time nor a name,
/// so that the same pieces give the same bytes with the same zlib.
class GzipEncoder {
 public:
  /// The file must outlive it.
  explicit GzipEncoder(AtomicFile& file);
  GzipEncoder(const GzipEncoder&) = delete;
  GzipEncoder& operator=(const GzipEncoder&) = delete;
  ~GzipEncoder();

  /// Throws `OutputError` when the disk does not take it.
  void write(std::string_view bytes);
  /// Once, after the last piece: what is missing of the file. Throws `OutputError`.
  void finish();

 private:
  void deflate_all(std::string_view bytes, int flush);

  AtomicFile& file_;
  std::unique_ptr<z_stream_s> stream_;
};

}  // namespace dcem::io
