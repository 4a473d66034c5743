#pragma once
/// Counts what a test program allocates, in the thread that does; everything is served as before. It replaces the
/// program's operator new, so one file of each test program includes it.
#include <cstddef>
#include <cstdlib>
#include <new>

namespace dcem_test {

inline thread_local std::size_t allocations = 0;

namespace detail {

inline void* counted_allocation(std::size_t size, std::size_t alignment) noexcept {
  ++allocations;
  // aligned_alloc wants a multiple of the alignment.
  return std::aligned_alloc(alignment, (size + alignment) / alignment * alignment);
}
inline void* or_throw(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace detail

}  // namespace dcem_test

// Never inlined: compilers and sanitizers would see free() beside an operator new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  return dcem_test::detail::or_throw(dcem_test::detail::counted_allocation(size, alignof(std::max_align_t)));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return dcem_test::detail::or_throw(dcem_test::detail::counted_allocation(size, static_cast<std::size_t>(alignment)));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return dcem_test::detail::counted_allocation(size, alignof(std::max_align_t));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
