#pragma once
/// Results of a run, frame by frame: `paths.jsonl` (or `.jsonl.gz`), `links.csv`, `pdp.csv`, `doppler.csv`, `cfr.npz`,
/// `paths.npz`, pictures of links and files for other programs.
///
/// Numbers have the fewest digits that read back as the same double. What is not defined is an empty field in CSV and
/// `null` in JSON, never NaN or infinity. The same results give the same bytes. docs/results.md names every column.
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/link_lines.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

class Beside;
class ThreadPool;

}  // namespace dcem

namespace dcem::io {

inline constexpr std::string_view pdp_csv_header = "frame,tx,rx,delay_s,power_dbm";
/// Where diffuse power is computed, its share of `power_dbm` follows.
inline constexpr std::string_view diffuse_pdp_csv_header = "frame,tx,rx,delay_s,power_dbm,power_diffuse_dbm";
inline constexpr std::string_view doppler_csv_header = "frame,tx,rx,doppler_hz,power_dbm";

/// What a writer must know of a run beside its scene.
struct ResultFacts {
  Discovery discovery = Discovery::exact;  ///< how paths were found
  double frequency_hz = 0.0;
  bool diffuse = false;        ///< diffuse power is computed
  bool diffuse_paths = false;  ///< and its tiles are listed among the paths
  std::size_t frames = 1;
  std::size_t first_frame = 0;  ///< `FrameResult::index` of the first of them
  int exact_interactions = 0;   ///< up to which all paths are found, where discovery is sampled beyond them
  double memory_limit_bytes = std::numeric_limits<double>::infinity();  ///< of the arrays of a file, beside their 16 GB
  bool all_links = true;  ///< every transmitter with every receiver; otherwise a frame says which links there are
  std::optional<GeoAnchor> geo{};  ///< where on the Earth the scene lies
  ThreadPool* pool = nullptr;      ///< makes the lines of a frame, which are written beside; none: the caller does all
};

/// Whether more is asked for than `links.csv`, whose lines say all that there is to write of a frame.
bool needs_paths(const OutputSettings& output);

/// The links that `output.plots` counts: transmitters times receivers, without those of a device to itself.
std::size_t plotted_links(const Scene& scene, std::span<const Device> receivers);

class CsvLine;
class FrameExport;
class GzipEncoder;
class PathCollector;
class PathLines;
class PlotCollector;
class ResponseCollector;

/// Writes the files that `output` asks for into a folder; the caller commits the folder after the last frame.
class ResultWriter {
 public:
  /// `receivers` are those that `LinkResult::receiver` indexes. The folder and the scene must outlive the writer, and
  /// the scene may move between the frames. Throws `OutputError`, and std::invalid_argument where responses over the
  /// band or paths as arrays would need more memory than 16 GB or the limit, or where pictures cannot be as they are
  /// asked for.
  ResultWriter(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers, const ResultFacts& facts,
               const OutputSettings& output);
  ~ResultWriter();

  /// Appends a frame. Lines are in the order of the frame's links. Throws `OutputError`, be it of the frame before, and
  /// std::invalid_argument where the paths as arrays would need more memory than 16 GB or the limit.
  void write(const FrameResult& frame);
  /// The lines of `links.csv` of a frame; empty where it is not asked for.
  [[nodiscard]] LinePieces link_lines(const FrameResult& frame);
  /// Appends a frame that is known by these lines alone. Precondition: no more than they is asked for. Throws
  /// `OutputError`, be it of the frame before.
  void write_lines(LinePieces lines);
  void write_lines(std::string_view lines);
  /// The file of `links.csv`, all of it that has been written in its place aside, for who appends its lines by other
  /// means. Precondition: it is asked for. Throws `OutputError`.
  const AtomicFile& links_so_far();
  /// After the last frame, be it the last that was announced or not: writes what is complete only now. `note` ends the
  /// titles of pictures: what they may lack. Throws `OutputError`.
  void finish(const std::string& note = {});

 private:
  struct Sheet {
    AtomicFile* file = nullptr;         // absent: not asked for
    std::unique_ptr<GzipEncoder> gzip;  // absent: the file is plain

    Sheet();
    ~Sheet();
    void write(std::string_view text);
  };
  /// What some links bring to each sheet.
  struct Lines {
    std::string paths, links, profile, doppler;
  };

  ThreadPool& pool() { return facts_.pool != nullptr ? *facts_.pool : *alone_; }
  Lines lines_of(const FrameResult& frame, std::span<const LinkResult> links) const;
  CsvLine begin_line(std::string& text, const FrameResult& frame, const LinkResult& link) const;
  void append_profile(std::string& text, const FrameResult& frame, const LinkResult& link) const;
  void append_doppler(std::string& text, const FrameResult& frame, const LinkResult& link) const;

  OutputSettings output_;
  ResultFacts facts_;
  const Scene& scene_;
  LinkLines link_lines_;
  std::unique_ptr<ThreadPool> alone_;
  Sheet paths_, links_, profile_, doppler_;
  std::unique_ptr<PathLines> lines_;
  // Absent: not asked for.
  std::unique_ptr<ResponseCollector> responses_;
  std::unique_ptr<PathCollector> arrays_;
  std::unique_ptr<PlotCollector> plots_;
  std::vector<std::unique_ptr<FrameExport>> exports_;
  std::vector<double> power_dbm_;    // of each transmitter
  std::unique_ptr<Beside> writing_;  // to the sheets; the first to go
};

}  // namespace dcem::io
