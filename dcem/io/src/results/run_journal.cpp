#include "dcem/io/run_journal.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "dcem/core/beside.hpp"
#include "dcem/core/random.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/results/frame_archive.hpp"
#include "dcem/io/src/results/link_pieces.hpp"

namespace dcem::io {
namespace {

namespace fs = std::filesystem;

// The pieces of a frame, in this order: its figures, its links one by one or its lines, its end.
constexpr char figures_piece = 'F', link_piece = 'L', lines_piece = 'T', end_piece = 'E';

std::uint64_t first_word(std::string_view bytes) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data(), sizeof word);
  return word;
}

/// Eight bytes at a time, in four chains: one waits for its last word to be mixed. A trace may have gigabytes.
std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t hash) {
  constexpr std::size_t chains = 4, word = sizeof(std::uint64_t);
  if (bytes.size() >= chains * word) {
    std::array<std::uint64_t, chains> mixed{};
    for (std::size_t chain = 0; chain < chains; ++chain) mixed[chain] = hash_values(hash, chain);
    for (; bytes.size() >= chains * word; bytes.remove_prefix(chains * word)) {
      for (std::size_t chain = 0; chain < chains; ++chain) {
        mixed[chain] = RandomStream(mixed[chain] ^ first_word(bytes.substr(chain * word))).next();
      }
    }
    for (const std::uint64_t chain : mixed) hash = RandomStream(hash ^ chain).next();
  }
  for (; bytes.size() >= word; bytes.remove_prefix(word)) hash = RandomStream(hash ^ first_word(bytes)).next();
  std::uint64_t rest = bytes.size();
  for (const char byte : bytes) rest = rest << 8U | static_cast<unsigned char>(byte);
  return RandomStream(hash ^ rest).next();
}

std::uint64_t hash_piece(char kind, std::string_view bytes) {
  return hash_bytes(bytes, hash_values(bytes.size(), static_cast<unsigned char>(kind)));
}

/// What stands before the bytes of a piece.
std::string piece_head(char kind, std::string_view bytes) {
  const std::array<std::uint64_t, 2> numbers{bytes.size(), hash_piece(kind, bytes)};
  std::string head(1, kind);
  head.append(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
  return head;
}

std::string piece(char kind, const std::string& bytes) {
  return piece_head(kind, bytes) + bytes;
}

/// The first piece of a frame: which link each line is of, and how many links or pieces of lines follow, too.
std::string first_piece(const FrameFigures& figures, const std::vector<LinkRequest>& of_lines, std::size_t links,
                        std::size_t lines) {
  ByteWriter writer;
  writer(figures, of_lines, links, lines);
  return piece(figures_piece, writer.bytes());
}

std::string hexadecimal(std::uint64_t number) {
  std::string digits;
  for (int shift = 60; shift >= 0; shift -= 4) digits.push_back("0123456789abcdef"[number >> shift & 15U]);
  return digits;
}

constexpr std::string_view options_word = "options ";

/// The first lines of a journal.
std::array<std::string, 4> head_lines(const RunIdentity& identity) {
  return {"dcem-journal/3", "version " + identity.version, "inputs " + hexadecimal(identity.inputs),
          std::string(options_word) + identity.options};
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

RunJournal::RunJournal(const fs::path& folder, const RunIdentity& identity, ThreadPool* pool)
    : file_(folder / journal_name),
      is_kept_(false),
      pool_(pool),
      alone_(std::make_unique<ThreadPool>(1)),
      writing_(std::make_unique<Beside>(pool != nullptr && pool->size() > 1)) {
  begin(head_lines(identity));
}

/// Under its name there is never less than the head, wherever the program is killed.
void RunJournal::begin(std::span<const std::string> head) {
  const fs::path unnamed = fs::path(file_) += ".new";
  stream_.open(unnamed, std::ios::binary | std::ios::trunc);
  for (const std::string& line : head) stream_ << line << '\n';
  std::error_code error;
  if (stream_.flush()) fs::rename(unnamed, file_, error);
  if (stream_ && !error) return;
  fs::remove(unnamed, error);
  throw OutputError(file_, "cannot be written", "a folder that can be written, with space left");
}

RunJournal::RunJournal(const fs::path& folder, std::uint64_t bytes, ThreadPool* pool)
    : file_(folder / journal_name),
      is_kept_(true),
      pool_(pool),
      alone_(std::make_unique<ThreadPool>(1)),
      writing_(std::make_unique<Beside>(pool != nullptr && pool->size() > 1)) {
  std::error_code error;
  fs::resize_file(file_, bytes, error);
  if (!error) stream_.open(file_, std::ios::binary | std::ios::app);
  if (error || !stream_) throw OutputError(file_, "cannot be continued", "a file that can be written");
}

RunJournal::~RunJournal() {
  settle();
  if (!is_kept_) remove();
}

void RunJournal::add(const FrameResult& frame) {
  std::string first = first_piece(figures_of(frame), {}, frame.links.size(), 0);
  const auto make = [](std::span<const LinkResult> links) {
    std::string pieces;
    for_each_link(links, [&](const LinkResult& link) {
      ByteWriter writer;
      writer(link);
      pieces += piece(link_piece, writer.bytes());
    });
    return pieces;
  };
  in_pieces<std::string>(pool(), frame.links, make, [&](std::vector<std::string>&& pieces) {
    writing_->start([this, first = std::exchange(first, {}), pieces = std::move(pieces)] {
      write(first);
      for (const std::string& one : pieces) write(one);
    });
  });
  writing_->start([this, first = std::move(first)] {
    write(first);
    end_frame();
  });
}

void RunJournal::add(const FrameFigures& figures, std::span<const LinkResult> links, const LinePieces& lines) {
  std::vector<LinkRequest> of_lines(links.size());
  std::vector<std::string> heads(lines->size());
  pool().for_each(heads.size(), [&](std::size_t index, unsigned) {
    heads[index] = piece_head(lines_piece, (*lines)[index]);
    const std::size_t first = links.size() * index / heads.size(), last = links.size() * (index + 1) / heads.size();
    for (std::size_t at = first; at < last; ++at) of_lines[at] = {links[at].transmitter, links[at].receiver};
  });
  writing_->start([this, figures, of_lines = std::move(of_lines), heads = std::move(heads), lines] {
    write(first_piece(figures, of_lines, 0, heads.size()));
    for (std::size_t index = 0; index < heads.size(); ++index) {
      write(heads[index]);
      write((*lines)[index]);
    }
    end_frame();
  });
}

void RunJournal::wait() {
  writing_->wait();
}

void RunJournal::write(std::string_view bytes) {
  stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

void RunJournal::end_frame() {
  write(piece(end_piece, {}));
  if (!stream_.flush()) throw OutputError(file_, "cannot be written to its end", "a disk with space left");
  has_frames_ = true;
}

/// Where an error has been told already, or nobody asks.
void RunJournal::settle() {
  try {
    wait();
  } catch (const std::exception&) {
    // What is not whole is left out by who reads it.
  }
}

void RunJournal::keep() {
  settle();
  is_kept_ = is_kept_ || has_frames_;
}

void RunJournal::remove() {
  settle();
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
  if (std::error_code ignored; !fs::is_regular_file(file_, ignored)) {
    throw InputError(file_.string(), "is no file; expected the journal of a run");
  }
  size_ = fs::file_size(file_);
  check_head(identity, scenario, use);
  count_frames(use);
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
    throw InputError(file_.string(), "is of a run with other options (" + found[3].substr(options_word.size()) +
                                         ") than this one (" + identity.options + "); expected the same");
  }
}

void JournalReader::count_frames(JournalUse use) {
  const auto begin = stream_.tellg();
  bytes_ = static_cast<std::uint64_t>(begin);
  for (auto head = next_head(); head; head = next_head()) {
    if (use == JournalUse::resume ? !rest_of(*head) : !pass_over(*head)) break;
    if (head->kind != end_piece) continue;
    ++frames_;
    bytes_ = static_cast<std::uint64_t>(stream_.tellg());
  }
  stream_.clear();
  stream_.seekg(begin);
}

std::optional<JournalReader::PieceHead> JournalReader::next_head() {
  PieceHead head;
  if (!stream_.get(head.kind)) return std::nullopt;
  for (std::uint64_t* number : {&head.size, &head.hash}) {
    stream_.read(reinterpret_cast<char*>(number), sizeof *number);
  }
  if (!stream_ || head.size > size_) return std::nullopt;
  return head;
}

/// What follows a head; nothing where it is not what was written.
std::optional<JournalReader::Piece> JournalReader::rest_of(const PieceHead& head) {
  Piece piece{head.kind, std::string(head.size, '\0')};
  stream_.read(piece.bytes.data(), static_cast<std::streamsize>(head.size));
  if (!stream_ || hash_piece(piece.kind, piece.bytes) != head.hash) return std::nullopt;
  return piece;
}

/// Whether there is all that follows a head.
bool JournalReader::pass_over(const PieceHead& head) {
  stream_.seekg(static_cast<std::streamoff>(head.size), std::ios::cur);
  return stream_ && static_cast<std::uint64_t>(stream_.tellg()) <= size_;
}

std::optional<JournalReader::Piece> JournalReader::next_piece() {
  const auto head = next_head();
  return head ? rest_of(*head) : std::nullopt;
}

void JournalReader::fail() const {
  throw InputError(file_.string(), "is damaged, or has changed while it was read; expected the journal of a run");
}

std::optional<JournalEntry> JournalReader::next() {
  if (read_ == frames_) return std::nullopt;
  ++read_;
  try {
    JournalEntry entry;
    std::size_t links = 0, lines = 0, lines_read = 0;
    for (auto piece = next_piece(); piece; piece = next_piece()) {
      ByteReader reader(piece->bytes);
      if (piece->kind == figures_piece) reader(entry.figures, entry.line_links, links, lines);
      if (piece->kind == link_piece) reader(entry.links.emplace_back());
      if (piece->kind == lines_piece) entry.link_lines += piece->bytes, ++lines_read;
      if (piece->kind == end_piece && links == entry.links.size() && lines == lines_read) return entry;
    }
  } catch (const std::runtime_error&) {
    // As where the file ends too early.
  }
  fail();
}

std::optional<FrameFigures> JournalReader::pass() {
  if (read_ == frames_) return std::nullopt;
  ++read_;
  try {
    FrameFigures figures;
    const auto first = next_piece();
    const bool is_whole = first && first->kind == figures_piece;
    if (is_whole) ByteReader(first->bytes)(figures);
    for (auto head = next_head(); is_whole && head && pass_over(*head); head = next_head()) {
      if (head->kind == end_piece) return figures;
    }
  } catch (const std::runtime_error&) {
    // As where the file ends too early.
  }
  fail();
}

}  // namespace dcem::io
