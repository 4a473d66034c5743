#pragma once
/// Memory in huge pages, for large arrays that are read here and there.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <type_traits>
#include <vector>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace dcem {

namespace detail {

#if defined(__linux__)

inline std::size_t whole_pages(std::size_t bytes, std::size_t page_bytes) {
  return (bytes + page_bytes - 1) / page_bytes * page_bytes;
}

/// Fresh memory that begins with a page. (What an allocator gives may have been used before, in small pages, and stays
/// in those.)
inline void* map_memory(std::size_t bytes, std::size_t page_bytes, bool in_huge_pages) {
  const std::size_t wanted = whole_pages(bytes, page_bytes), more = wanted + page_bytes;
  if (more < bytes) throw std::bad_alloc();
  void* const mapped = ::mmap(nullptr, more, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  auto* const first = static_cast<char*>(mapped);
  const std::size_t before = (page_bytes - reinterpret_cast<std::uintptr_t>(first) % page_bytes) % page_bytes;
  if (before > 0) ::munmap(first, before);
  if (before < page_bytes) ::munmap(first + before + wanted, page_bytes - before);
  // A wish: where it is not granted the memory is as good as any other.
  if (in_huge_pages) ::madvise(first + before, wanted, MADV_HUGEPAGE);
  return first + before;
}
inline void unmap_memory(void* memory, std::size_t bytes, std::size_t page_bytes) {
  ::munmap(memory, whole_pages(bytes, page_bytes));
}

#else

inline void* map_memory(std::size_t bytes, std::size_t page_bytes, bool) {
  return ::operator new (bytes, std::align_val_t{page_bytes});
}
inline void unmap_memory(void* memory, std::size_t, std::size_t page_bytes) {
  ::operator delete (memory, std::align_val_t{page_bytes});
}

#endif

}  // namespace detail

/// For large arrays asks the operating system for pages of 2 MiB instead of 4 KiB: a processor knows the places of some
/// thousand pages only, and has to look up those of all others before it can read them. Where the system grants none,
/// it changes nothing. Any such allocator may give back what another one took.
template <typename Item>
class HugePageAllocator {
 public:
  using value_type = Item;
  using is_always_equal = std::true_type;
  using propagate_on_container_copy_assignment = std::true_type;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  static constexpr std::size_t page_bytes = std::size_t{1} << 21;
  static constexpr std::size_t least_bytes = page_bytes;  ///< less would leave most of a page unused

  HugePageAllocator() = default;
  explicit HugePageAllocator(bool asks) : asks_(asks) {}
  template <typename Other>
  HugePageAllocator(const HugePageAllocator<Other>& other) : asks_(other.asks()) {}

  /// Whether it asks the system at all.
  bool asks() const { return asks_; }

  Item* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(Item)) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(Item);
    return static_cast<Item*>(bytes < least_bytes ? ::operator new(bytes, alignment)
                                                  : detail::map_memory(bytes, page_bytes, asks_));
  }
  void deallocate(Item* memory, std::size_t count) {
    const std::size_t bytes = count * sizeof(Item);
    bytes < least_bytes ? ::operator delete(memory, alignment) : detail::unmap_memory(memory, bytes, page_bytes);
  }

  template <typename Other>
  friend bool operator==(const HugePageAllocator&, const HugePageAllocator<Other>&) {
    return true;
  }

 private:
  static constexpr std::align_val_t alignment{alignof(Item)};

  bool asks_ = true;
};

template <typename Item>
using HugePageVector = std::vector<Item, HugePageAllocator<Item>>;

}  // namespace dcem
