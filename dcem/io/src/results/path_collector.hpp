#pragma once
/// The paths of a run as dense arrays, for `paths.npz` and `paths.mat`. Private to dcem::io.
#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/npz_writer.hpp"
#include "dcem/io/result_writer.hpp"

namespace dcem::io {

/// Arrays over frames F, receivers R, transmitters T, paths P and interactions D; P is the longest list of paths and D
/// the longest list of interactions of the run, each at least 1. docs/results.md names the arrays. They have the names,
/// units and codes of Sionna RT's `Paths`; `a` is NaN where an end is dual-polarized.
class PathCollector {
 public:
  /// Throws std::invalid_argument as `add` does.
  PathCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers, const ResultFacts& facts,
                const OutputSettings& output);

  /// Throws std::invalid_argument, with the memory needed, as soon as the arrays of `ResultFacts::frames` frames with
  /// lists as long as those seen so far would need more than 16 GB, or one of them more than a MAT file can hold.
  void add(const FrameResult& frame);
  void write();

 private:
  struct Touch {
    std::uint32_t code = 0;
    Vec3 point_m{0.0};
  };
  /// A path, and where it stands in the arrays.
  struct Row {
    std::size_t link = 0;  // (frame·R + receiver)·T + transmitter
    std::size_t slot = 0;  // 0…P − 1
    std::size_t first_touch = 0, touches = 0;
    std::complex<double> amplitude{};
    ComplexMatrix2 transfer{};
    double delay_s = 0.0, doppler_hz = 0.0;
    Direction departure, arrival;
  };

  void add_link(const LinkResult& link);
  void check_memory() const;
  std::size_t links() const { return times_s_.size() * receivers_.size() * transmitters_.size(); }
  /// `value(row)` at the place of each row, `filler` elsewhere.
  template <typename Value, typename Pick>
  std::vector<Value> dense(Value filler, Pick&& value) const;
  NpzWriter::Shape shape(bool by_interaction, std::initializer_list<std::size_t> more = {}) const;
  // Into either archive: both have the same functions.
  template <typename Archive>
  void add_all(Archive& archive) const;
  template <typename Archive>
  void add_fields(Archive& archive) const;
  template <typename Archive>
  void add_angles(Archive& archive) const;
  template <typename Archive>
  void add_interactions(Archive& archive) const;

  AtomicFile* npz_ = nullptr;  // absent: not asked for
  AtomicFile* mat_ = nullptr;
  ResultFacts facts_;
  std::vector<std::string> transmitters_, receivers_;
  std::vector<double> times_s_;
  std::vector<Row> rows_;
  std::vector<Touch> touches_;
  std::size_t longest_list_ = 1, most_interactions_ = 1;
};

}  // namespace dcem::io
