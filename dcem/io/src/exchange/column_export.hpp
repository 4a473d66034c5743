#pragma once
/// The paths of large runs as columns, paths.h5. Private to dcem::io.
///
/// Group `paths`: a row for each path, in the order of paths.jsonl. Group `links`: a row for each link of a frame, with
/// the range of its paths. Group `frames`: a row for each frame. `tx_id`, `rx_id`: what the numbers in `links` mean.
#include <cstdint>
#include <string>
#include <vector>

#include "dcem/io/src/exchange/column_file.hpp"
#include "dcem/io/src/exchange/frame_export.hpp"

namespace dcem::io {

/// The names that `output.hdf5.columns` may have.
std::vector<std::string> path_column_names();

class Hdf5Export : public FrameExport {
 public:
  explicit Hdf5Export(const ExportContext& context);
  void add(const FrameResult& frame, const Frame& instant) override;
  void finish() override;

 private:
  /// A column with what is not yet in the file.
  struct NumberColumn {
    std::size_t number = 0;
    std::size_t kind = 0;  // place in the table of all columns
    std::vector<double> values{};
  };
  struct CountColumn {
    std::size_t number = 0;
    std::vector<std::uint64_t> values{};
  };

  void open_columns(const ExportContext& context);
  void add_link(std::size_t frame, const LinkResult& link);
  void hand_over(std::size_t least_rows);

  AtomicFile& file_;
  ColumnFile columns_;
  std::vector<double> power_dbm_;
  bool diffuse_paths_;
  std::vector<NumberColumn> paths_;
  CountColumn link_frame_, link_tx_, link_rx_, link_first_, link_count_, frame_index_;
  NumberColumn frame_time_;
  std::uint64_t rows_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace dcem::io
