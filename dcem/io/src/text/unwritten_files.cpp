#include "dcem/io/src/text/unwritten_files.hpp"

#include "dcem/core/error.hpp"

namespace dcem::io {
namespace {

thread_local const UnwrittenFiles::Texts* read_instead = nullptr;

}  // namespace

UnwrittenFiles::UnwrittenFiles(Texts&& texts) {
  DCEM_ASSERT(read_instead == nullptr);
  for (auto& [file, text] : texts) texts_.emplace(file.lexically_normal(), std::move(text));
  read_instead = &texts_;
}

UnwrittenFiles::~UnwrittenFiles() {
  read_instead = nullptr;
}

const std::string* UnwrittenFiles::find(const std::filesystem::path& file) {
  if (read_instead == nullptr) return nullptr;
  const auto found = read_instead->find(file.lexically_normal());
  return found == read_instead->end() ? nullptr : &found->second;
}

}  // namespace dcem::io
