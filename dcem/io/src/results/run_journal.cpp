#include "dcem/io/run_journal.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "dcem/core/random.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/results/frame_archive.hpp"

namespace dcem::io {
namespace {

namespace fs = std::filesystem;

// The pieces of a frame, in this order: its figures, its links one by one, its end.
constexpr char figures_piece = 'F', link_piece = 'L', end_piece = 'E';

/// Eight bytes at a time: a trace may have gigabytes.
std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t hash) {
  std::uint64_t word = 0;
  for (; bytes.size() >= sizeof word; bytes.remove_prefix(sizeof word)) {
    std::memcpy(&word, bytes.data(), sizeof word);
    hash = RandomStream(hash ^ word).next();
  }
  word = bytes.size();
  for (const char byte : bytes) word = word << 8U | static_cast<unsigned char>(byte);
  return RandomStream(hash ^ word).next();
}

std::uint64_t hash_piece(char kind, std::string_view bytes) {
  return hash_bytes(bytes, hash_values(bytes.size(), static_cast<unsigned char>(kind)));
}

std::string hexadecimal(std::uint64_t number) {
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits.push_back("0123456789abcdef"[number >> shift & 15U]);
  return digits;
}

/// The first lines of a journal.
std::array<std::string, 4> head_lines(const RunIdentity& identity) {
  return {"dcem-journal/1", "version " + identity.version, "inputs " + hexadecimal(identity.inputs),
          "options " + identity.options};
}

}  // namespace

std::uint64_t content_hash(std::span<const fs::path> files) {
  std::uint64_t hash = files.size();
  std::string block(std::size_t{1} << 20, '\0');
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    std::uint64_t size = 0;
    while (stream) {
      stream.read(block.data(), static_cast<std::streamsize>(block.size()));
      const auto count = static_cast<std::size_t>(stream.gcount());
      hash = hash_bytes(std::string_view(block).substr(0, count), hash);
      size += count;
    }
    if (!stream.eof()) throw InputError(file.string(), "cannot be read; expected a file that stays as it is");
    hash = hash_values(hash, size);
  }
  return hash;
}

std::string RunIdentity::text() const {
  return hexadecimal(hash_values(hash_text(version), inputs, hash_text(options)));
}

FrameResult JournalEntry::take_result() {
  return {figures.index, figures.time_s, std::move(links),      figures.work,
          figures.tree,  figures.cache,  figures.update_time_s, figures.solve_time_s};
}

RunJournal::RunJournal(const fs::path& folder, const RunIdentity& identity)
    : file_(folder / journal_name), stream_(file_, std::ios::binary | std::ios::trunc), is_kept_(false) {
  for (const std::string& line : head_lines(identity)) stream_ << line << '\n';
  if (!stream_.flush()) throw OutputError(file_, "cannot be written", "a folder that can be written, with space left");
}

RunJournal::RunJournal(const fs::path& folder, std::uint64_t bytes) : file_(folder / journal_name), is_kept_(true) {
  std::error_code error;
  fs::resize_file(file_, bytes, error);
  if (!error) stream_.open(file_, std::ios::binary | std::ios::app);
  if (error || !stream_) throw OutputError(file_, "cannot be continued", "a file that can be written");
}

RunJournal::~RunJournal() {
  if (!is_kept_) remove();
}

void RunJournal::add(const FrameResult& frame) {
  ByteWriter figures;
  figures(figures_of(frame), std::string(), std::vector<LinkRequest>(), frame.links.size());
  put(figures_piece, figures.bytes());
  for (const LinkResult& link : frame.links) {
    ByteWriter writer;
    writer(link);
    put(link_piece, writer.bytes());
  }
  end_frame();
}

void RunJournal::add(const FrameResult& frame, const std::string& link_lines) {
  ByteWriter figures;
  std::vector<LinkRequest> line_links;
  for (const LinkResult& link : frame.links) line_links.push_back({link.transmitter, link.receiver});
  figures(figures_of(frame), link_lines, line_links, std::size_t{0});
  put(figures_piece, figures.bytes());
  end_frame();
}

void RunJournal::put(char kind, std::string_view bytes) {
  const std::uint64_t size = bytes.size(), hash = hash_piece(kind, bytes);
  stream_.put(kind);
  for (const std::uint64_t number : {size, hash}) {
    stream_.write(reinterpret_cast<const char*>(&number), sizeof number);
  }
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void RunJournal::end_frame() {
  put(end_piece, {});
  if (!stream_.flush()) throw OutputError(file_, "cannot be written to its end", "a disk with space left");
  has_frames_ = true;
}

void RunJournal::remove() {
  stream_.close();
  std::error_code ignored;
  fs::remove(file_, ignored);
}

JournalReader::JournalReader(const fs::path& folder, const RunIdentity& identity, const std::string& scenario,
                             JournalUse use)
    : file_(folder / journal_name), stream_(file_, std::ios::binary) {
  if (!stream_) {
    throw InputError(folder.string(), "nothing to resume; expected the folder of a run that was ended, with its " +
                                          std::string(journal_name));
  }
  size_ = fs::file_size(file_);
  check_head(identity, scenario, use);
  count_frames();
}

void JournalReader::check_head(const RunIdentity& identity, const std::string& scenario, JournalUse use) {
  const std::array<std::string, 4> expected = head_lines(identity);
  std::array<std::string, 4> found;
  for (std::string& line : found) std::getline(stream_, line);
  if (found[0] != expected[0]) throw InputError(file_.string(), "is no journal of a run; expected a run to resume");
  if (found[1] != expected[1]) {
    throw InputError(file_.string(), "is of another version of dcem; expected this one (" + identity.version + ')');
  }
  if (found[2] != expected[2]) {
    throw InputError(scenario,
                     "is not as it was when the run began, or a file that it names is not; expected the same " +
                         std::string(use == JournalUse::resume ? "(without --resume the run begins anew)"
                                                               : "(otherwise all parts are to be run again)"));
  }
  if (found[3] != expected[3]) {
    throw InputError(file_.string(), "is of a run with other options; expected those of that run (" +
                                         found[3].substr(std::string("options ").size()) + ')');
  }
}

void JournalReader::count_frames() {
  const auto begin = stream_.tellg();
  bytes_ = static_cast<std::uint64_t>(begin);
  while (const auto piece = next_piece()) {
    if (piece->kind != end_piece) continue;
    ++frames_;
    bytes_ = static_cast<std::uint64_t>(stream_.tellg());
  }
  stream_.clear();
  stream_.seekg(begin);
}

std::optional<JournalReader::Piece> JournalReader::next_piece() {
  std::uint64_t size = 0, hash = 0;
  Piece piece;
  if (!stream_.get(piece.kind)) return std::nullopt;
  for (std::uint64_t* number : {&size, &hash}) stream_.read(reinterpret_cast<char*>(number), sizeof *number);
  if (!stream_ || size > size_) return std::nullopt;
  piece.bytes.resize(size);
  stream_.read(piece.bytes.data(), static_cast<std::streamsize>(size));
  if (!stream_ || hash_piece(piece.kind, piece.bytes) != hash) return std::nullopt;
  return piece;
}

std::optional<JournalEntry> JournalReader::next() {
  if (read_ == frames_) return std::nullopt;
  ++read_;
  try {
    JournalEntry entry;
    std::size_t links = 0;
    for (auto piece = next_piece(); piece; piece = next_piece()) {
      ByteReader reader(piece->bytes);
      if (piece->kind == figures_piece) reader(entry.figures, entry.link_lines, entry.line_links, links);
      if (piece->kind == link_piece) reader(entry.links.emplace_back());
      if (piece->kind == end_piece && links == entry.links.size()) return entry;
    }
  } catch (const std::runtime_error&) {
    // As where the file ends too early.
  }
  throw InputError(file_.string(), "has changed while it was read; expected the journal of a run");
}

}  // namespace dcem::io
