#pragma once
/// A run in parts, each of some of the receivers, and what the parts leave as one run. docs/design/shards.md has the
/// reasons.
///
/// The folder of a part holds its journal, `run.journal`, and a `summary.json` whose member `shard` says of which run
/// it is a part. There is no summary before the part is whole.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/run_journal.hpp"
#include "dcem/io/shard_facts.hpp"

namespace dcem::io {

/// A folder with what its summary says.
struct ShardFolder {
  std::filesystem::path folder;
  ShardFacts facts;
};

/// The parts of one run in their order. Throws InputError where a folder holds no part or one that is not whole, where
/// parts are of different runs, and where one is missing or there twice.
std::vector<ShardFolder> read_shards(std::span<const std::filesystem::path> folders);

/// The same frame of all parts, whose links are each in their order, as the frame of the run: its links by transmitter,
/// then receiver; counts of work added up, times those of the slowest. The tree's report is that of the first part.
/// Throws std::invalid_argument where they are different frames.
JournalEntry joined_entry(std::vector<JournalEntry>&& parts);

/// The journals of all parts, frame by frame.
class ShardReader {
 public:
  /// `identities`: one per part, as `JournalReader` wants them. Throws InputError as that does, and where a part holds
  /// other than `frames` frames.
  ShardReader(std::span<const ShardFolder> shards, std::span<const RunIdentity> identities, const std::string& scenario,
              std::size_t frames);

  /// The next frame; nothing behind the last. Throws InputError where a file has changed meanwhile.
  std::optional<JournalEntry> next();
  /// The figures of the next frame, whose links or lines are passed over unread; otherwise as `next`.
  std::optional<FrameFigures> pass();
  /// Of the journals, for each frame.
  std::size_t bytes_a_frame() const;

 private:
  std::vector<JournalReader> readers_;
};

}  // namespace dcem::io
