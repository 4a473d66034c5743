#pragma once
/// Who a message is about.
#include <stdexcept>
#include <string>

namespace dcem {

namespace detail {

/// Does something, and puts `name` before the message where it throws std::invalid_argument.
template <typename Action>
void naming(const std::string& name, Action&& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(name + ": " + error.what());
  }
}

}  // namespace detail

}  // namespace dcem
