#include "dcem/io/run_journal.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/results/frame_archive.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_run_journal {

using namespace dcem;
using io::JournalReader;
using io::RunIdentity;
using io::RunJournal;
using test::file_bytes;
using test::TemporaryFolder;

namespace {

const RunIdentity identity{"1.2.3", 77, "--frames 0:5"};

PathContribution path_with_everything(double x) {
  PathContribution path;
  path.path.interactions = {{InteractionKind::diffraction, FacetId(3), {x, -0.0, 1e-300}, WedgeId(9), true},
                            {InteractionKind::scattering, FacetId(4), {1, 2, 3}}};
  path.path.length_m = std::nextafter(x, 10.0);
  path.path.foliage = {{MaterialId(2), 0.125}};
  path.transfer(1, 0) = {std::numeric_limits<double>::denorm_min(), -x};
  path.amplitude = {std::numeric_limits<double>::quiet_NaN(), 0.1};
  path.has_amplitude = false;
  path.ports(0, 1) = {3, 4};
  path.transmit_ports = 2;
  path.channel = ChannelMatrix(2, 3);
  path.channel(1, 2) = {5, 6};
  path.power_ratio = x / 3.0;
  path.departure = {0.1, 0.2};
  path.arrival = {0.3, 0.4};
  return path;
}

FrameResult frame_of(std::size_t index) {
  FrameResult frame{index, 0.1 * static_cast<double>(index), {}, {}, {}, {}, 0.25, 0.5};
  frame.work.rays = 11 + index;
  frame.work.diffuse_residual_db = 0.3;
  frame.tree.sah_cost = 1.0 / 3.0;
  frame.tree.rebuilt_in_place = 5;
  frame.cache.died = 6;
  LinkResult link{1, index, true, {path_with_everything(1.5), path_with_everything(2.5)}, {}, {}};
  link.diffuse.tiles = {{{0.5, 1e-8, 3.0, {1, 2}, {3, 4}}, {7, 8}, 12, 13, {{}, 2.0, {}}, 0.75}};
  link.diffuse.residual_ratio = 0.01;
  link.diffuse.traversal.primitives_tested = 4;
  link.diffuse.converged = false;
  link.statistics.line_of_sight = true;
  link.statistics.rms_doppler_spread_hz = -0.0;
  frame.links = {link, LinkResult{}};
  return frame;
}

/// All that a frame holds, to the last bit.
std::string bytes_of(const FrameResult& frame) {
  io::ByteWriter writer;
  writer(io::figures_of(frame), frame.links);
  return writer.bytes();
}

std::string message_of(const auto& action) {
  try {
    action();
  } catch (const io::InputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Frames 0, 1, … of a journal, which must be those of `frame_of`.
std::size_t frames_in(const TemporaryFolder& folder) {
  JournalReader reader(folder.path(), identity, "drive.json");
  std::size_t frames = 0;
  for (auto entry = reader.next(); entry; entry = reader.next()) {
    CHECK((bytes_of(entry->take_result()) == bytes_of(frame_of(frames))));
    ++frames;
  }
  CHECK(frames == reader.frames());
  return frames;
}

void write_journal(const TemporaryFolder& folder, std::size_t frames) {
  RunJournal journal(folder.path(), identity);
  for (std::size_t index = 0; index < frames; ++index) journal.add(frame_of(index));
  journal.keep();
}

/// Calls `look(at)` for journals of two frames, each with another byte of the second frame changed: the `at`-th of it.
template <typename Look>
void with_each_broken(const TemporaryFolder& folder, Look&& look) {
  write_journal(folder, 2);
  const std::filesystem::path file = folder / "run.journal";
  const std::string bytes = file_bytes(file);
  write_journal(folder, 1);
  const std::size_t one = file_bytes(file).size();
  for (std::size_t at = one; at < bytes.size(); at += 97) {
    CAPTURE(at);
    std::string broken = bytes;
    broken[at] = static_cast<char>(broken[at] ^ 0x10);
    std::ofstream(file, std::ios::binary) << broken;
    look(at - one);
  }
}

}  // namespace

TEST_CASE("frames come back as they were, to the last bit") {
  const TemporaryFolder folder;
  write_journal(folder, 3);
  CHECK(frames_in(folder) == 3);
  // The values themselves, not only their bytes.
  JournalReader reader(folder.path(), identity, "drive.json");
  reader.next();
  const FrameResult frame = reader.next()->take_result();
  CHECK(frame.index == 1);
  CHECK(frame.work.rays == 12);
  CHECK(frame.solve_time_s == 0.5);
  REQUIRE(frame.links.size() == 2);
  const PathContribution& path = frame.links[0].paths.at(1);
  CHECK(path.path.interactions.at(0).wedge == WedgeId(9));
  CHECK(path.path.interactions.at(0).in_shadow);
  CHECK(std::signbit(path.path.interactions.at(0).point_m.y));
  CHECK(std::isnan(path.amplitude.real()));
  CHECK(path.channel.rows() == 2);
  CHECK(path.channel(1, 2) == Complex(5, 6));
  CHECK(frame.links[0].diffuse.tiles.at(0).place == 13);
  CHECK(frame.links[0].diffuse.tiles.at(0).area_m2 == 0.75);
  CHECK(frame.links[0].statistics.rms_doppler_spread_hz.has_value());
  CHECK_FALSE(frame.links[0].statistics.power_dbm.has_value());
}

TEST_CASE("the number of threads changes no byte") {
  FrameResult frame = frame_of(3);
  for (std::size_t link = 0; link < 2000; ++link) {
    frame.links.push_back(frame.links[link % 2]);
    frame.links.back().transmitter = link;
  }
  const io::LinePieces lines =
      std::make_shared<const std::vector<std::string>>(std::vector<std::string>{"one\n", "two\n", "", "three\n"});
  const auto journal_of = [&](ThreadPool* pool) {
    const TemporaryFolder folder;
    RunJournal journal(folder.path(), identity, pool);
    journal.add(frame);
    journal.add(io::figures_of(frame_of(4)), frame_of(4).links, lines);
    journal.add(frame_of(5));
    journal.wait();
    journal.keep();
    JournalReader reader(folder.path(), identity, "drive.json");
    CHECK((bytes_of(reader.next()->take_result()) == bytes_of(frame)));
    CHECK(reader.next()->link_lines == "one\ntwo\nthree\n");
    CHECK((bytes_of(reader.next()->take_result()) == bytes_of(frame_of(5))));
    return file_bytes(folder / "run.journal");
  };
  const std::string alone = journal_of(nullptr);
  for (const unsigned threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    CHECK((journal_of(&pool) == alone));
  }
}

TEST_CASE("wherever a journal was cut off, the whole frames before are read, and it goes on behind them") {
  const TemporaryFolder folder;
  write_journal(folder, 2);
  const std::filesystem::path file = folder / "run.journal";
  const std::string bytes = file_bytes(file);
  write_journal(folder, 1);
  const std::size_t one = file_bytes(file).size();
  write_journal(folder, 0);  // nothing is kept without a frame
  CHECK_FALSE(std::filesystem::exists(file));
  std::size_t head = 0;
  for (int line = 0; line < 4; ++line) head = bytes.find('\n', head) + 1;
  for (std::size_t size = head; size <= bytes.size(); size += size + 40 < one || size > one + 40 ? 7 : 1) {
    CAPTURE(size);
    std::ofstream(file, std::ios::binary) << bytes.substr(0, size);
    const std::size_t expected = size == bytes.size() ? 2U : size >= one ? 1U : 0U;
    REQUIRE(frames_in(folder) == expected);
  }
  std::ofstream(file, std::ios::binary) << bytes.substr(0, bytes.size() - 3);
  {
    RunJournal journal(folder.path(), JournalReader(folder.path(), identity, "drive.json").bytes());
    journal.add(frame_of(1));
    journal.add(frame_of(2));
  }
  CHECK(frames_in(folder) == 3);
}

TEST_CASE("a byte that has changed ends a journal before its frame") {
  const TemporaryFolder folder;
  with_each_broken(folder, [&](std::size_t) { REQUIRE(frames_in(folder) == 1); });
}

TEST_CASE("frames that are passed over leave their figures, and the next one as it was") {
  const TemporaryFolder folder;
  write_journal(folder, 4);
  JournalReader reader(folder.path(), identity, "drive.json", io::JournalUse::merge);
  CHECK(reader.frames() == 4);
  for (const std::size_t index : {0U, 1U}) {
    const auto figures = reader.pass();
    REQUIRE(figures);
    CHECK(figures->index == index);
    CHECK(figures->work.rays == 11 + index);
    CHECK(figures->links == 2);
  }
  CHECK((bytes_of(reader.next()->take_result()) == bytes_of(frame_of(2))));
  CHECK(reader.pass()->index == 3);
  CHECK_FALSE(reader.pass());
  CHECK_FALSE(reader.next());
}

TEST_CASE("a byte that has changed in a journal that is to be merged is found out when its frame is read") {
  const TemporaryFolder folder;
  std::size_t passed_over = 0;
  with_each_broken(folder, [&](std::size_t at) {
    JournalReader reader(folder.path(), identity, "drive.json", io::JournalUse::merge);
    CHECK((bytes_of(reader.next()->take_result()) == bytes_of(frame_of(0))));
    if (reader.frames() == 1) return;  // its pieces are not as long as they say: the frame is not there
    CHECK(contains(message_of([&] { reader.next(); }), "run.journal: is damaged, or has changed"));
    if (at != 97) return;  // within the figures
    ++passed_over;
    JournalReader passing(folder.path(), identity, "drive.json", io::JournalUse::merge);
    CHECK(passing.pass());
    CHECK(contains(message_of([&] { passing.pass(); }), "run.journal: is damaged, or has changed"));
  });
  CHECK(passed_over == 1);  // or nothing was tried
}

TEST_CASE("lines in place of links take the room of lines") {
  const TemporaryFolder folder;
  {
    RunJournal journal(folder.path(), identity);
    const std::vector<std::string> lines{"0,0,mast,", "ue\n"};
    journal.add(io::figures_of(frame_of(0)), frame_of(0).links,
                std::make_shared<const std::vector<std::string>>(lines));
    journal.keep();
  }
  CHECK(std::filesystem::file_size(folder / "run.journal") < 700);
  JournalReader reader(folder.path(), identity, "drive.json");
  const auto entry = reader.next();
  REQUIRE(entry);
  CHECK(entry->link_lines == "0,0,mast,ue\n");
  CHECK(entry->links.empty());
  CHECK(entry->figures.links == 2);
  CHECK(entry->figures.paths == 2);
}

TEST_CASE("a journal goes when nobody keeps it") {
  const TemporaryFolder folder;
  {
    RunJournal journal(folder.path(), identity);
    journal.add(frame_of(0));
    CHECK(std::filesystem::exists(folder / "run.journal"));
  }
  CHECK(folder.names().empty());
  {
    RunJournal journal(folder.path(), identity);
    journal.add(frame_of(0));
    journal.keep();
  }
  {
    // One that was there before stays, whatever becomes of this run ...
    RunJournal journal(folder.path(), JournalReader(folder.path(), identity, "drive.json").bytes());
  }
  CHECK(frames_in(folder) == 1);
  RunJournal(folder.path(), JournalReader(folder.path(), identity, "drive.json").bytes())
      .remove();  // ... or it is whole
  CHECK(folder.names().empty());
}

TEST_CASE("the journal of another run is refused, and it is said what differs") {
  const TemporaryFolder folder;
  const auto refused = [&](const RunIdentity& other) {
    return message_of([&] { JournalReader(folder.path(), other, "drive.json"); });
  };
  CHECK(contains(refused(identity), "nothing to resume; expected "));
  write_journal(folder, 1);
  CHECK(refused(identity) == "nothing was thrown");
  CHECK(contains(refused({"1.2.4", 77, "--frames 0:5"}), "another version of dcem; expected this one (1.2.4)"));
  CHECK(refused({"1.2.3", 78, "--frames 0:5"}).starts_with("drive.json: is not as it was"));
  CHECK(contains(
      refused({"1.2.3", 77, "--frames 0:6"}),
      "run.journal: is of a run with other options (--frames 0:5) than this one (--frames 0:6); expected the same"));
  std::ofstream(folder / "run.journal") << "something else";
  CHECK(contains(refused(identity), "is no journal"));
  CHECK(RunIdentity(identity).text() != RunIdentity{"1.2.3", 78, "--frames 0:5"}.text());
}

TEST_CASE("the hash of files tells every byte, and where one file ends") {
  const TemporaryFolder folder;
  const auto hash = [&](const std::vector<std::string>& contents) {
    std::vector<std::filesystem::path> files;
    for (const std::string& bytes : contents) {
      files.push_back(folder / std::to_string(files.size()));
      std::ofstream(files.back(), std::ios::binary) << bytes;
    }
    return io::content_hash(files);
  };
  const std::string text(3'000'001, 'x');
  const std::uint64_t whole = hash({text, "y"});
  CHECK(whole == hash({text, "y"}));
  for (const std::size_t at : {std::size_t{0}, std::size_t{1'048'575}, std::size_t{1'048'576}, text.size() - 1}) {
    std::string other = text;
    other[at] = 'z';
    CHECK(hash({other, "y"}) != whole);
  }
  CHECK(hash({text + "y", ""}) != whole);
  CHECK(hash({text}) != whole);
  CHECK(hash({"", std::string(1, '\0')}) != hash({std::string(1, '\0'), ""}));
  CHECK(message_of([&] { io::content_hash(std::vector<std::filesystem::path>{folder / "absent"}); }) !=
        "nothing was thrown");
}

TEST_CASE("a journal has its head from the moment it has its name: one that cannot begin leaves the one before whole") {
  const TemporaryFolder folder;
  write_journal(folder, 2);
  std::filesystem::create_directories(folder / "run.journal.new/in the way");
  CHECK_THROWS_AS(RunJournal(folder.path(), identity), io::OutputError);
  CHECK(frames_in(folder) == 2);
  std::filesystem::remove_all(folder / "run.journal.new");
  RunJournal(folder.path(), identity).keep();
  CHECK(folder.names().empty());
}

TEST_CASE("a folder that takes no journal is an error") {
  CHECK_THROWS_AS(RunJournal("/proc", identity), io::OutputError);
  const TemporaryFolder folder;
  CHECK_THROWS_AS(RunJournal(folder.path(), std::uint64_t{12}), io::OutputError);
}

}  // namespace test_run_journal
