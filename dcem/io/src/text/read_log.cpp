#include "dcem/io/src/text/read_log.hpp"

#include <algorithm>

namespace dcem::io {
namespace {

thread_local ReadLog* innermost = nullptr;

}  // namespace

ReadLog::ReadLog() : outer_(innermost) {
  innermost = this;
}

ReadLog::~ReadLog() {
  innermost = outer_;
}

void ReadLog::note(const std::filesystem::path& file) {
  for (ReadLog* log = innermost; log != nullptr; log = log->outer_) {
    if (std::find(log->files_.begin(), log->files_.end(), file) == log->files_.end()) log->files_.push_back(file);
  }
}

}  // namespace dcem::io
