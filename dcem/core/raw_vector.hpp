#pragma once
/// A vector whose new elements are not cleared: who makes room for megabytes may leave it to the threads that fill it
/// to touch it first.
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace dcem {

namespace detail {

/// Leaves elements as they are where nothing is said of their value.
template <typename T>
struct RawAllocator : std::allocator<T> {
  static_assert(std::is_trivially_default_constructible_v<T> && std::is_trivially_destructible_v<T>);

  template <typename Other>
  struct rebind {
    using other = RawAllocator<Other>;
  };

  RawAllocator() = default;
  template <typename Other>
  RawAllocator(const RawAllocator<Other>& /*of_others*/) {}  // an allocator of elements is one of all elements

  template <typename Element>
  void construct(Element* place) {
    ::new (static_cast<void*>(place)) Element;
  }
  template <typename Element, typename... Arguments>
  void construct(Element* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) Element(std::forward<Arguments>(arguments)...);
  }
};

}  // namespace detail

/// `resize(count)` leaves elements without a value, which must be written before they are read.
template <typename T>
using RawVector = std::vector<T, detail::RawAllocator<T>>;

}  // namespace dcem
