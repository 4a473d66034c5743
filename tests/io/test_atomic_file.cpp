#include "dcem/io/atomic_file.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/io/temporary_folder.hpp"

namespace test_atomic_file {

using dcem::io::AtomicFile;
using dcem::io::OutputError;
using dcem::io::OutputFolder;
using dcem::test::file_bytes;
using dcem::test::TemporaryFolder;
using Names = std::vector<std::string>;

namespace {

// Lets no file grow beyond a few bytes: a write fails midway, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t limit_bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    rlimit limit = old_limit_;
    limit.rlim_cur = limit_bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int) = nullptr;
};

std::string message_of(const auto& action) {
  try {
    action();
  } catch (const OutputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a file has its name only after commit, and then all its bytes") {
  const TemporaryFolder folder;
  AtomicFile file(folder / "links.csv");
  file.stream() << "frame,tx\n";
  file.write("0,bs\r\n");
  CHECK_FALSE(std::filesystem::exists(folder / "links.csv"));
  CHECK(folder.names().size() == 1);
  file.commit();
  CHECK(folder.names() == Names{"links.csv"});
  CHECK(file_bytes(folder / "links.csv") == "frame,tx\n0,bs\r\n");
}

TEST_CASE("a file that is not committed leaves nothing and spares the old one") {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder / "old.csv");
    file.write("old");
    file.commit();
  }
  {
    AtomicFile file(folder / "old.csv");
    file.write("new and half");
    file.close();
    AtomicFile fresh(folder / "fresh.csv");
    fresh.write("x");
  }
  CHECK(folder.names() == Names{"old.csv"});
  CHECK(file_bytes(folder / "old.csv") == "old");
}

TEST_CASE("a moved file is committed once, by its last owner") {
  const TemporaryFolder folder;
  std::optional<AtomicFile> last;
  {
    AtomicFile first(folder / "a.csv");
    first.write("1");
    last.emplace(std::move(first));
  }
  last->write("2");
  last->commit();
  CHECK(file_bytes(folder / "a.csv") == "12");
}

TEST_CASE("two writers of one file do not mix: the last commit wins as a whole") {
  const TemporaryFolder folder;
  AtomicFile first(folder / "a.csv");
  AtomicFile second(folder / "a.csv");
  first.write("first");
  second.write("second");
  second.commit();
  first.commit();
  CHECK(file_bytes(folder / "a.csv") == "first");
  CHECK(folder.names() == Names{"a.csv"});
}

TEST_CASE("a disk that takes only part of a file is an error, wherever the bytes came from") {
  const TemporaryFolder folder;
  const std::string bytes(100'000, 'x');
  const FileSizeLimit limit(4096);
  SUBCASE("through write") {
    AtomicFile file(folder / "big.csv");
    CHECK_THROWS_AS(file.write(bytes), OutputError);
    CHECK_THROWS_AS(file.commit(), OutputError);
  }
  SUBCASE("through the stream") {
    AtomicFile file(folder / "big.csv");
    file.stream() << bytes;
    CHECK_THROWS_AS(file.commit(), OutputError);
    CHECK_THROWS_AS(file.commit(), OutputError);
  }
  SUBCASE("while flushing what still lies in the buffer") {
    AtomicFile file(folder / "big.csv");
    for (int i = 0; i < 5000; ++i) file.stream() << 'x';
    const std::string message = message_of([&] { file.commit(); });
    CHECK(contains(message, "big.csv: "));
    CHECK(contains(message, "; expected "));
  }
  CHECK(folder.names().empty());
}

TEST_CASE("places that cannot take a file are named") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  CHECK(contains(message_of([&] { AtomicFile file(folder / "sub"); }), "sub: is a folder; expected "));
  CHECK(contains(message_of([&] { AtomicFile file(folder / "absent/a.csv"); }), "a.csv: cannot be written ("));
  CHECK(contains(message_of([&] { AtomicFile file("/proc/dcem.csv"); }), "/proc/dcem.csv: cannot be written ("));
  CHECK(contains(message_of([&] { AtomicFile file("/dev/null"); }), "/dev/null: is not a regular file; expected "));
  CHECK(contains(message_of([&] { AtomicFile file(folder.path() / ""); }), "is no file name"));
  CHECK(folder.names() == Names{"sub"});
}

TEST_CASE("the files of a folder appear together") {
  const TemporaryFolder base;
  const std::filesystem::path target = base / "out/town/run1";
  OutputFolder folder(target);
  AtomicFile& paths = folder.open("paths.jsonl");
  folder.open("links.csv").stream() << "links";
  paths.write("paths");
  CHECK_FALSE(std::filesystem::exists(target / "paths.jsonl"));
  CHECK_FALSE(std::filesystem::exists(target / "links.csv"));
  folder.commit();
  CHECK(file_bytes(target / "paths.jsonl") == "paths");
  CHECK(file_bytes(target / "links.csv") == "links");
  CHECK(std::distance(std::filesystem::directory_iterator(target), {}) == 2);
}

TEST_CASE("a folder without commit leaves nothing, not even itself") {
  const TemporaryFolder base;
  {
    OutputFolder folder(base / "out/town/");
    folder.open("links.csv").write("half");
    CHECK(std::filesystem::is_directory(base / "out/town"));
  }
  CHECK(base.names().empty());
}

TEST_CASE("a folder that was there stays, with what others put there") {
  const TemporaryFolder base;
  std::filesystem::create_directory(base / "mine");
  {
    OutputFolder known(base / "mine");
    OutputFolder created(base / "shared");
    known.open("a.csv").write("a");
    AtomicFile other(base / "shared/other.csv");
    other.commit();
  }
  CHECK(base.names() == Names{"mine", "shared"});
  CHECK(std::filesystem::is_empty(base / "mine"));
  CHECK(std::filesystem::exists(base / "shared/other.csv"));
}

TEST_CASE("one incomplete file keeps back all files of a folder") {
  const TemporaryFolder base;
  {
    OutputFolder folder(base / "out");
    const FileSizeLimit limit(4096);
    folder.open("small.csv").write("small");
    folder.open("big.csv").stream() << std::string(100'000, 'x');
    CHECK_THROWS_AS(folder.commit(), OutputError);
  }
  CHECK(base.names().empty());
}

TEST_CASE("a commit that fails on one file spares the old results of all") {
  const TemporaryFolder base;
  {
    AtomicFile old(base / "small.csv");
    old.write("old");
    old.commit();
  }
  {
    OutputFolder folder(base.path());
    const FileSizeLimit limit(4096);
    folder.open("small.csv").write("new");
    folder.open("big.csv").stream() << std::string(100'000, 'x');
    CHECK_THROWS_AS(folder.commit(), OutputError);
  }
  CHECK(base.names() == Names{"small.csv"});
  CHECK(file_bytes(base / "small.csv") == "old");
}

TEST_CASE("a rename that fails in the midst takes back the files renamed before") {
  const TemporaryFolder base;
  {
    OutputFolder folder(base / "out");
    folder.open("first.csv").write("1");
    folder.open("second.csv").write("2");
    // Between open and commit somebody puts a folder where the second file goes.
    std::filesystem::create_directories(base / "out/second.csv/inside");
    CHECK_THROWS_AS(folder.commit(), OutputError);
    CHECK_FALSE(std::filesystem::exists(base / "out/first.csv"));
  }
  std::filesystem::remove_all(base / "out/second.csv");
  CHECK(std::filesystem::is_empty(base / "out"));
}

TEST_CASE("a folder that cannot be written fails at once") {
  const TemporaryFolder base;
  {
    AtomicFile file(base / "file");
    file.commit();
  }
  CHECK_THROWS_AS(OutputFolder(base / "file"), OutputError);
  CHECK_THROWS_AS(OutputFolder(base / "file/out"), OutputError);
  CHECK_THROWS_AS(OutputFolder("/proc"), OutputError);
  CHECK(contains(message_of([] { OutputFolder folder("/proc/dcem/out"); }), "/proc/dcem/out: cannot be created ("));
  CHECK(base.names() == Names{"file"});
}

TEST_CASE("names of a folder's files stay inside and differ") {
  const TemporaryFolder base;
  OutputFolder folder(base / "out");
  folder.open("a.csv");
  for (const char* name :
       {"a.csv", "", ".", "..", "../c.csv", "b/../c.csv", "b/", "./c.csv", "b//c.csv", "/etc/c.csv"}) {
    CHECK_THROWS_AS(folder.open(name), std::invalid_argument);
  }
}

TEST_CASE("a folder is that of one run at a time") {
  const TemporaryFolder base;
  {
    const OutputFolder first(base / "out");
    CHECK(contains(message_of([&] { OutputFolder second(base / "out"); }),
                   "/out: another run is writing there; expected "));
    const OutputFolder other(base / "other");
  }
  CHECK_NOTHROW(OutputFolder(base / "out"));
}

TEST_CASE("what a killed program left aside is removed; what is in use, and what is somebody else's, is not") {
  const TemporaryFolder base;
  const AtomicFile mine(base / "mine.csv");
  // A process that has ended, and been waited for, is no more.
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  const std::string dead = std::to_string(child), alive = std::to_string(::getppid());
  const Names others{".links.csv." + alive + "-0.part",
                     ".links.csv." + dead + ".part",
                     ".links.csv.part",
                     ".part",
                     ".x." + dead + "-0.parts",
                     ".x.-5-0.part",
                     "links.csv." + dead + "-0.part"};
  for (const std::string& name : others) std::ofstream(base / name) << "x";
  const std::string own = std::to_string(::getpid());
  for (const std::string& name :
       {".links.csv." + dead + "-0.part", "..dcem-commit." + dead + "-17.part", ".mine.csv." + own + "-99999.part"}) {
    std::ofstream(base / name) << "x";
  }
  const OutputFolder folder(base.path());
  Names left = base.names();
  CHECK(std::erase_if(left, [](const std::string& name) { return name.starts_with(".mine.csv."); }) == 1);
  Names expected = others;
  std::sort(expected.begin(), expected.end());
  CHECK(left == expected);
}

TEST_CASE("a program that is killed while its files take their names leaves no mixture for the next run") {
  const TemporaryFolder base;
  for (const char* name : {"new.csv", "old.csv", "notes.txt"}) std::ofstream(base / name) << "x";
  std::ofstream(base / ".dcem-commit") << "new.csv\nold.csv\nabsent.csv\n../" << base.path().filename().string()
                                       << "/notes.txt\n";
  { const OutputFolder folder(base.path()); }
  CHECK(base.names() == Names{"notes.txt"});
}

TEST_CASE("a commit takes away the former result, and nothing else") {
  const TemporaryFolder base;
  for (const char* name : {"old.csv", "both.csv", "notes.txt"}) std::ofstream(base / name) << "x";
  std::filesystem::create_directory(base / "folder");
  std::filesystem::create_symlink("notes.txt", base / "link");
  OutputFolder folder(base.path());
  folder.open("both.csv").write("new");
  CHECK(folder.names() == Names{"both.csv"});
  folder.commit({"old.csv", "both.csv", "folder", "link", "absent", "../x"});
  CHECK(base.names() == Names{"both.csv", "folder", "link", "notes.txt"});
  CHECK(file_bytes(base / "both.csv") == "new");
}

TEST_CASE("files below the folder appear with the others, in folders that go with them") {
  const TemporaryFolder base;
  {
    OutputFolder folder(base / "out/");  // as users write it
    folder.open("a.csv").write("a");
    folder.open("below/deep/b.csv").write("b");
    folder.open("below/c.csv").write("c");
    CHECK_FALSE(std::filesystem::exists(base / "out/below"));
    CHECK(folder.names() == Names{"a.csv", "below/deep/b.csv", "below/c.csv"});
    folder.commit();
  }
  CHECK(file_bytes(base / "out/below/deep/b.csv") == "b");
  CHECK(file_bytes(base / "out/below/c.csv") == "c");
  std::ofstream(base / "out/below/notes.txt") << "mine";
  OutputFolder next(base / "out");
  next.open("a.csv").write("new");
  next.commit({"a.csv", "below/deep/b.csv", "below/c.csv"});
  CHECK_FALSE(std::filesystem::exists(base / "out/below/deep"));
  CHECK(file_bytes(base / "out/below/notes.txt") == "mine");
  CHECK(file_bytes(base / "out/a.csv") == "new");
}

TEST_CASE("a folder below that is a link is neither followed nor replaced") {
  const TemporaryFolder base;
  std::filesystem::create_directories(base / "elsewhere");
  std::ofstream(base / "elsewhere/b.csv") << "mine";
  std::filesystem::create_directories(base / "out");
  std::filesystem::create_directory_symlink(base / "elsewhere", base / "out/below");
  OutputFolder folder(base / "out");
  CHECK(contains(message_of([&] { folder.open("below/b.csv"); }), "/out/below: is not a folder; expected "));
  folder.open("a.csv").write("a");
  folder.commit({"below/b.csv"});
  CHECK(file_bytes(base / "elsewhere/b.csv") == "mine");
}

TEST_CASE("a file that rests between its pieces has all of them") {
  const TemporaryFolder base;
  AtomicFile file(base / "a.csv");
  file.rest();
  for (const char* piece : {"one ", "two ", "three"}) {
    file.write(piece);
    file.rest();
    file.rest();
  }
  CHECK_FALSE(std::filesystem::exists(base / "a.csv"));
  file.commit();
  CHECK(file_bytes(base / "a.csv") == "one two three");
}

}  // namespace test_atomic_file
