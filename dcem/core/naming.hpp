#pragma once
/// Who a message is about.
#include <concepts>
#include <stdexcept>
#include <string>

namespace dcem {

namespace detail {

/// Does something, and puts `name()` before the message where it throws std::invalid_argument: for what is done so
/// often that names are made for those alone which are told.
template <std::invocable Name, typename Action>
void naming(const Name& name, Action&& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(name() + ": " + error.what());
  }
}

template <typename Action>
void naming(const std::string& name, Action&& action) {
  naming([&] { return name; }, action);
}

}  // namespace detail

}  // namespace dcem
