#include "dcem/io/shards.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/results/shard_json.hpp"

namespace dcem::io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* expected_folder = "the folder of 'dcem run --shard i/N', ended as it should";

ShardFolder read_shard(const fs::path& folder) {
  std::ifstream stream(folder / "summary.json");
  const Json summary = stream ? Json::parse(stream, nullptr, false) : Json();
  const bool has_journal = fs::exists(folder / journal_name);
  if (!stream && has_journal) {
    throw InputError(folder.string(), "holds a part that is not whole; expected " + std::string(expected_folder) +
                                          " ('dcem run' with the same options and --resume goes on)");
  }
  if (!summary.is_object() || !summary.contains("shard") || !has_journal) {
    throw InputError(folder.string(), "holds no part of a run; expected " + std::string(expected_folder));
  }
  if (!summary.value("interrupted", Json()).is_null()) {
    throw InputError(folder.string(),
                     "holds a part that was interrupted; expected a whole one ('dcem run' with the "
                     "same options and --resume goes on)");
  }
  try {
    return {folder, shard_facts(summary["shard"])};
  } catch (const Json::exception&) {
    throw InputError((folder / "summary.json").string(), "is damaged; expected " + std::string(expected_folder));
  }
}

bool is_same_run(const ShardFacts& one, const ShardFacts& other) {
  const auto as_part = [](ShardFacts facts, const ReceiverPart& part) {
    facts.part = part;
    return shard_json(facts);
  };
  return one.part.of == other.part.of && as_part(one, {}) == as_part(other, {});
}

void require_one_run(const std::vector<ShardFolder>& shards) {
  for (const ShardFolder& shard : shards) {
    if (is_same_run(shard.facts, shards.front().facts)) continue;
    throw InputError(shard.folder.string(), "is of another run than " + shards.front().folder.string() +
                                                "; expected parts of one scenario with the same options");
  }
}

void require_all(const std::vector<ShardFolder>& shards) {
  const std::uint32_t count = shards.front().facts.part.of;
  for (std::uint32_t number = 0; number < count; ++number) {
    const auto is_wanted = [&](const ShardFolder& shard) { return shard.facts.part.part == number; };
    const auto first = std::find_if(shards.begin(), shards.end(), is_wanted);
    const std::string name = "part " + shard_text({number, count});
    const std::string wanted = "each of the " + std::to_string(count) + " parts once";
    if (first == shards.end()) {
      throw InputError(shards.front().folder.string(), name + " is in none of the folders; expected " + wanted);
    }
    const auto second = std::find_if(std::next(first), shards.end(), is_wanted);
    if (second != shards.end()) {
      throw InputError(second->folder.string(),
                       "holds " + name + " as " + first->folder.string() + " does; expected " + wanted);
    }
  }
}

/// A line of `links.csv` and whose it is.
struct LinkLine {
  LinkRequest link;
  std::string_view text;
};

bool comes_before(const LinkRequest& one, const LinkRequest& other) {
  return std::pair(one.transmitter, one.receiver) < std::pair(other.transmitter, other.receiver);
}

std::vector<LinkLine> lines_of(const JournalEntry& entry) {
  std::vector<LinkLine> lines;
  std::string_view rest = entry.link_lines;
  for (const LinkRequest& link : entry.line_links) {
    const std::size_t size = std::min(rest.find('\n'), rest.size() - 1) + 1;
    lines.push_back({link, rest.substr(0, size)});
    rest.remove_prefix(size);
  }
  return lines;
}

void join_lines(std::span<const JournalEntry> parts, JournalEntry& whole) {
  std::vector<LinkLine> lines;
  for (const JournalEntry& part : parts) {
    const std::vector<LinkLine> own = lines_of(part);
    lines.insert(lines.end(), own.begin(), own.end());
  }
  std::sort(lines.begin(), lines.end(),
            [](const LinkLine& one, const LinkLine& other) { return comes_before(one.link, other.link); });
  for (const LinkLine& line : lines) {
    whole.link_lines += line.text;
    whole.line_links.push_back(line.link);
  }
}

void add_figures(FrameFigures& sum, const FrameFigures& part) {
  if (part.index != sum.index) throw std::invalid_argument("parts of a run: expected the same frame of all of them");
  sum.links += part.links;
  sum.links_with_line_of_sight += part.links_with_line_of_sight;
  sum.paths += part.paths;
  sum.update_time_s = std::max(sum.update_time_s, part.update_time_s);
  sum.solve_time_s = std::max(sum.solve_time_s, part.solve_time_s);
  sum.cache += part.cache;
  sum.work += part.work;
}

}  // namespace

std::vector<ShardFolder> read_shards(std::span<const fs::path> folders) {
  std::vector<ShardFolder> shards;
  for (const fs::path& folder : folders) shards.push_back(read_shard(folder));
  require_one_run(shards);
  require_all(shards);
  std::sort(shards.begin(), shards.end(), [](const ShardFolder& one, const ShardFolder& other) {
    return one.facts.part.part < other.facts.part.part;
  });
  return shards;
}

JournalEntry joined_entry(std::vector<JournalEntry>&& parts) {
  JournalEntry whole;
  whole.figures = parts.at(0).figures;
  for (std::size_t index = 1; index < parts.size(); ++index) add_figures(whole.figures, parts[index].figures);
  join_lines(parts, whole);
  for (JournalEntry& part : parts) {
    std::move(part.links.begin(), part.links.end(), std::back_inserter(whole.links));
  }
  std::sort(whole.links.begin(), whole.links.end(), [](const LinkResult& one, const LinkResult& other) {
    return comes_before({one.transmitter, one.receiver}, {other.transmitter, other.receiver});
  });
  return whole;
}

ShardReader::ShardReader(std::span<const ShardFolder> shards, std::span<const RunIdentity> identities,
                         const std::string& scenario, std::size_t frames) {
  for (std::size_t index = 0; index < shards.size(); ++index) {
    readers_.emplace_back(shards[index].folder, identities[index], scenario, JournalUse::merge);
    if (readers_.back().frames() == frames) continue;
    throw InputError(shards[index].folder.string(), "holds " + std::to_string(readers_.back().frames()) +
                                                        " whole frames; expected all " + std::to_string(frames));
  }
}

std::optional<JournalEntry> ShardReader::next() {
  std::vector<JournalEntry> parts;
  for (JournalReader& reader : readers_) {
    auto entry = reader.next();
    if (!entry) return std::nullopt;
    parts.push_back(std::move(*entry));
  }
  return joined_entry(std::move(parts));
}

std::optional<FrameFigures> ShardReader::pass() {
  std::optional<FrameFigures> whole;
  for (JournalReader& reader : readers_) {
    const auto figures = reader.pass();
    if (!figures) return std::nullopt;
    whole ? add_figures(*whole, *figures) : void(whole = figures);
  }
  return whole;
}

std::size_t ShardReader::bytes_a_frame() const {
  std::uint64_t bytes = 0;
  for (const JournalReader& reader : readers_) bytes += reader.bytes();
  return readers_.empty() || readers_.front().frames() == 0 ? 0 : bytes / readers_.front().frames();
}

}  // namespace dcem::io
