#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <fstream>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "failure.hpp"
#include "options.hpp"
#include "ranks.hpp"

namespace dcem::program {
namespace {

constexpr int work_tag = 1;
constexpr long long no_more = -1;

/// MPI waits by asking without end: a core that others could use.
void rest() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void wait_for(MPI_Request& request) {
  int done = 0;
  for (MPI_Test(&request, &done, MPI_STATUS_IGNORE); done == 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE)) rest();
}

unsigned size_of(MPI_Comm group) {
  int size = 1;
  MPI_Comm_size(group, &size);
  return static_cast<unsigned>(size);
}

unsigned processes_on_this_machine() {
  MPI_Comm neighbours = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &neighbours);
  const unsigned count = size_of(neighbours);
  MPI_Comm_free(&neighbours);
  return count;
}

/// The numbers of a piece of work, one after the other, for the threads of the first process.
class Numbers {
 public:
  Numbers(std::size_t count, const std::function<void()>& finished) : count_(count), finished_(finished) {}

  /// The next one; `done`: who asks has done one before.
  long long next(bool done) {
    const std::lock_guard lock(mutex_);
    if (done) finished_();
    return next_ < count_ ? static_cast<long long>(next_++) : no_more;
  }

 private:
  std::mutex mutex_;
  std::size_t count_, next_ = 0;
  const std::function<void()>& finished_;
};

/// Serves all other processes until each has been told that there is no more.
void serve(Numbers& numbers, unsigned others) {
  while (others > 0) {
    MPI_Status status;
    int is_asked = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, work_tag, MPI_COMM_WORLD, &is_asked, &status);
    if (is_asked == 0) {
      rest();
      continue;
    }
    int has_done_one = 0;
    MPI_Recv(&has_done_one, 1, MPI_INT, status.MPI_SOURCE, work_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    const long long number = numbers.next(has_done_one != 0);
    MPI_Send(&number, 1, MPI_LONG_LONG, status.MPI_SOURCE, work_tag, MPI_COMM_WORLD);
    if (number == no_more) --others;
  }
}

long long ask_first(bool done) {
  const int has_done_one = done ? 1 : 0;
  long long number = no_more;
  MPI_Send(&has_done_one, 1, MPI_INT, 0, work_tag, MPI_COMM_WORLD);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Irecv(&number, 1, MPI_LONG_LONG, 0, work_tag, MPI_COMM_WORLD, &request);
  wait_for(request);
  return number;
}

/// A file that all processes write to.
class FileOfAll {
 public:
  /// What one process writes at once: MPI counts bytes with an int.
  static constexpr std::uint64_t most_at_once = std::uint64_t{1} << 30U;

  FileOfAll(const std::filesystem::path& file, std::filesystem::path name, unsigned own)
      : name_(std::move(name)), own_(own) {
    problem_ = MPI_File_open(MPI_COMM_WORLD, file.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &handle_);
    MPI_Offset size = 0;
    if (problem_ == MPI_SUCCESS) problem_ = MPI_File_get_size(handle_, &size);
    end_ = static_cast<std::uint64_t>(size);
  }
  FileOfAll(const FileOfAll&) = delete;
  FileOfAll& operator=(const FileOfAll&) = delete;
  /// All processes close it together.
  ~FileOfAll() {
    if (handle_ != MPI_FILE_NULL) MPI_File_close(&handle_);
  }

  /// Throws OutputError where this process cannot have opened it, or written to it.
  void check() const {
    if (problem_ == MPI_SUCCESS) return;
    std::array<char, MPI_MAX_ERROR_STRING> why{};
    int size = 0;
    MPI_Error_string(problem_, why.data(), &size);
    throw io::OutputError(name_,
                          "process " + std::to_string(own_) + " cannot write to it together with the others (" +
                              std::string(why.data(), static_cast<std::size_t>(size)) + ')',
                          "a disk with space left that all processes see ('dcem merge' of run.parts/* needs but one)");
  }

  /// All processes write what they have, one behind the other. `sizes`: of what each has.
  void append(const std::string& bytes, const std::vector<std::uint64_t>& sizes) {
    const auto own = sizes.begin() + own_;
    const std::uint64_t begin = std::accumulate(sizes.begin(), own, end_);
    for (std::uint64_t at = 0; at < *own; at += most_at_once) {
      write(begin + at, bytes.data() + at, static_cast<int>(std::min(most_at_once, *own - at)));
    }
    end_ = std::accumulate(sizes.begin(), sizes.end(), end_);
  }

  /// All processes wait until it is on the disk: what a file system says of that only when the file is closed, MPI does
  /// not tell.
  void sync() {
    const int problem = MPI_File_sync(handle_);
    if (problem_ == MPI_SUCCESS) problem_ = problem;
  }

 private:
  /// Not MPI_File_write_at_all: where that fails on one process, those of Open MPI 4.1 wait for it for ever.
  void write(std::uint64_t place, const char* bytes, int size) {
    MPI_Status status;
    const auto offset = static_cast<MPI_Offset>(place);
    const int problem = MPI_File_write_at(handle_, offset, bytes, size, MPI_BYTE, &status);
    int written = 0;
    if (problem == MPI_SUCCESS) MPI_Get_count(&status, MPI_BYTE, &written);
    if (problem_ == MPI_SUCCESS) problem_ = problem != MPI_SUCCESS || written == size ? problem : MPI_ERR_NO_SPACE;
  }

  std::filesystem::path name_;
  unsigned own_;
  MPI_File handle_ = MPI_FILE_NULL;
  int problem_ = MPI_SUCCESS;
  std::uint64_t end_ = 0;
};

/// Others are deep in their work: nobody waits for them.
[[noreturn]] void end_job(const Failure& failure) {
  fail(failure);
  MPI_Abort(MPI_COMM_WORLD, failure.exit_code);
  std::abort();
}

template <typename Next>
void work_on(const std::function<void(std::size_t)>& work, const Next& next) {
  try {
    for (long long number = next(false); number != no_more; number = next(true)) work(static_cast<std::size_t>(number));
  } catch (...) {
    end_job(current_failure());
  }
}

}  // namespace

std::string rank_library() {
  int version = 0, part = 0;
  MPI_Get_version(&version, &part);
  return "MPI " + std::to_string(version) + '.' + std::to_string(part);
}

Ranks::Ranks() {
  int level = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
  count_ = size_of(MPI_COMM_WORLD);
  if (count_ != job_size() || level < MPI_THREAD_SERIALIZED) {
    if (job_rank() > 0) end_behind_first();
    throw UsageError("mpirun: not that of the MPI that DCEM was built with, or one that knows no threads",
                     "the mpirun of " + rank_library() + " that was there then");
  }
  int own = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &own);
  own_ = static_cast<unsigned>(own);
  here_ = processes_on_this_machine();
}

Ranks::~Ranks() {
  MPI_Finalize();
}

void Ranks::together(const std::function<void()>& action) const {
  std::exception_ptr thrown;
  int exit_code = 0;
  try {
    action();
  } catch (...) {
    thrown = std::current_exception();
    exit_code = current_failure().exit_code;
  }
  std::vector<int> codes(count_);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(&exit_code, 1, MPI_INT, codes.data(), 1, MPI_INT, MPI_COMM_WORLD, &request);
  wait_for(request);
  for (unsigned rank = 0; rank < count_; ++rank) {
    if (codes[rank] == 0) continue;
    if (rank == own_) std::rethrow_exception(thrown);
    throw EndedElsewhere{codes[rank]};
  }
}

std::uint64_t Ranks::of_first(std::uint64_t number) const {
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibcast(&number, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD, &request);
  wait_for(request);
  return number;
}

std::string Ranks::of_first(std::string text) const {
  text.resize(of_first(text.size()));
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibcast(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, MPI_COMM_WORLD, &request);
  wait_for(request);
  return text;
}

std::vector<std::uint64_t> Ranks::of_all(std::uint64_t number) const {
  std::vector<std::uint64_t> numbers(count_);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallgather(&number, 1, MPI_UINT64_T, numbers.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD, &request);
  wait_for(request);
  return numbers;
}

void Ranks::append(const std::filesystem::path& file, const std::filesystem::path& name, std::size_t count,
                   const std::function<std::string(std::size_t)>& piece) const {
  // Who cannot open it by MPI may wait for the others for ever.
  together([&] {
    if (std::fstream(file, std::ios::in | std::ios::out | std::ios::binary)) return;
    throw io::OutputError(name, "process " + std::to_string(own_) + " cannot open it",
                          "a folder that all processes see");
  });
  FileOfAll shared(file, name, own_);
  together([&] { shared.check(); });
  std::string bytes;
  for (std::size_t first = 0; first < count; first += count_) {
    together([&] { bytes = first + own_ < count ? piece(first + own_) : std::string(); });
    shared.append(bytes, of_all(bytes.size()));
    together([&] { shared.check(); });
  }
  shared.sync();
  together([&] { shared.check(); });
}

void Ranks::share(std::size_t count, const std::function<void(std::size_t)>& work,
                  const std::function<void()>& finished) const {
  if (!is_first()) return work_on(work, ask_first);
  Numbers numbers(count, finished);
  // Only this thread speaks to others while the first process is at work itself.
  std::thread server([&] { serve(numbers, count_ - 1); });
  work_on(work, [&](bool done) { return numbers.next(done); });
  server.join();
}

}  // namespace dcem::program
