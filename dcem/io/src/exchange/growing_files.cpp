#include "dcem/io/src/exchange/growing_files.hpp"

namespace dcem::io {

std::size_t GrowingFiles::open(const std::string& name) {
  sheets_.push_back({&folder_.open(name)});
  sheets_.back().file->rest();
  return sheets_.size() - 1;
}

void GrowingFiles::append(std::size_t file, const std::string& text) {
  constexpr std::size_t most_waiting_bytes = 16u << 20;
  sheets_[file].text += text;
  waiting_bytes_ += text.size();
  if (waiting_bytes_ > most_waiting_bytes) hand_over();
}

void GrowingFiles::hand_over() {
  for (Sheet& sheet : sheets_) {
    if (sheet.text.empty()) continue;
    sheet.file->write(sheet.text);
    sheet.file->rest();
    sheet.text = {};
  }
  waiting_bytes_ = 0;
}

void GrowingFiles::close() {
  hand_over();
  for (Sheet& sheet : sheets_) sheet.file->close();
}

}  // namespace dcem::io
