#pragma once
/// What the command line of the program `dcem` says, and the commands that act on it.
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dcem/io/import.hpp"
#include "dcem/io/inspection.hpp"
#include "dcem/io/progress.hpp"
#include "dcem/io/scenario.hpp"

namespace dcem::program {

/// The command line asks for what cannot be: "command line: what is wrong; what was expected".
class UsageError : public std::runtime_error {
 public:
  UsageError(const std::string& problem, const std::string& expectation)
      : std::runtime_error("command line: " + problem + "; expected " + expectation) {}
};

/// A check was made and did not pass.
class CheckFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The words of KEY[,KEY...].
std::vector<std::string> words_of(const std::string& list);

/// Frames first, first + 1, …, last − 1.
struct FrameRange {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t count() const { return last - first; }
};

struct ScenarioOptions {
  std::string scenario;
  std::string folder;               ///< where results go; empty: out/<scenario name>
  std::optional<unsigned> threads;  ///< absent: as the scenario says, which is all cores
  /// Of what is foreseen. Absent: the machine's memory.
  std::optional<double> memory_limit_bytes;
  std::string frames;  ///< "A:B"; empty: all
  io::ScenarioOverrides overrides;
  /// More than one, in place of the scenario's: as many runs, one after the other (`frequencies.hpp`).
  std::vector<double> frequencies_hz;
  std::optional<std::string> map_output;  ///< "csv,png,…": of `dcem map`, in place of the file's `output`
  std::optional<ReceiverPart> shard;      ///< of `dcem run`: a part alone
  bool resume = false;
  io::ProgressMode progress = io::ProgressMode::automatic;
  bool quiet = false;
};

struct InspectOptions {
  std::string obj;
  io::InspectionSettings settings;
  bool json = false;
};

struct CompareOptions {
  std::string first, second;                    ///< CSV files
  std::string column = "power_incoherent_dbm";  ///< of both, unless the second has its own
  std::string second_column;
  std::string folder;                       ///< empty: out/compare
  std::vector<std::string> formats{"svg"};  ///< of the chart: png, svg, pdf
};

struct ImportOptions {
  std::string kind;  ///< sumo, gemv2, sionna, osm
  std::string source, folder;
  std::string polygons, trace;          ///< of sumo alone
  std::vector<std::string> additional;  ///< of sumo alone
  std::string touching = "union";       ///< or snap
  std::vector<std::string> given;       ///< the options that the command line has
  io::ImportSettings settings;
  bool quiet = false;
};

struct MergeOptions {
  std::vector<std::string> shards;  ///< folders
  std::string folder;               ///< empty: out/<scenario name>
  std::string scenario;             ///< empty: where it was
  std::optional<unsigned> threads;
  std::optional<double> memory_limit_bytes;
  io::ProgressMode progress = io::ProgressMode::automatic;
  bool quiet = false;
};

struct KeysOptions {
  std::string word;  ///< empty: all keys
  bool markdown = false;
};

// The commands. They return when everything is written; errors are thrown.

void run_scenario(const ScenarioOptions& options);
/// A part of a run: what --shard says.
void run_shard(const ScenarioOptions& options);
void merge_shards(const MergeOptions& options);
void map_scenario(const ScenarioOptions& options);
void verify_scenario(const ScenarioOptions& options);
void inspect_scene(const InspectOptions& options);
void compare_maps(const CompareOptions& options);
void import_scene(const ImportOptions& options);
void print_keys(const KeysOptions& options);
void print_schema();

}  // namespace dcem::program
