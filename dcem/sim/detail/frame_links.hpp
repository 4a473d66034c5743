#pragma once
/// The links of a frame: in which order threads take them, and in which they stand.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::detail {

/// From so many links on all threads look after them: of ten thousand vehicles they are 100 MB.
inline constexpr std::size_t many_links = 4096;

/// By receiver, the transmitters that it has links with, ascending.
using LinkLists = std::span<const std::vector<std::uint32_t>>;

/// Receivers by how many links they have, most first, so that no thread begins with the longest when all others are
/// done. Where they are very many it does not matter, and they stay in their order.
std::vector<std::size_t> busiest_first(LinkLists transmitters_of);

/// The links of one receiver, by transmitter, at their places.
class LinkSlots {
 public:
  /// One after the other.
  explicit LinkSlots(std::span<LinkResult> links) : links_(links.data()), size_(links.size()) {}
  /// So many in a list, at `places`.
  LinkSlots(LinkResult* links, const std::uint32_t* places, std::size_t size)
      : links_(links), places_(places), size_(size) {}

  std::size_t size() const { return size_; }
  LinkResult& operator[](std::size_t index) const { return links_[places_ == nullptr ? index : places_[index]]; }
  /// Says that links soon after this one will be written, first they and then the paths that they hold: of many
  /// vehicles they are far from each other, and long out of every cache.
  void fetch_after(std::size_t index) const;

 private:
  LinkResult* links_;
  const std::uint32_t* places_ = nullptr;
  std::size_t size_;
};

/// All links of a frame, by transmitter, then receiver. Each is solved where it stays.
class FrameLinks {
 public:
  /// They begin with `room`, links that nobody needs any more: fresh memory costs more than all else here.
  FrameLinks(LinkLists transmitters_of, std::vector<LinkResult>&& room, ThreadPool& pool);

  LinkSlots of(std::size_t receiver);
  std::vector<LinkResult> take() && { return std::move(links_); }

 private:
  std::vector<LinkResult> links_;
  std::vector<std::size_t> first_;           ///< of each receiver in `places_`, and the end
  std::unique_ptr<std::uint32_t[]> places_;  ///< by receiver, then transmitter
};

/// So many paths of a link that nobody needs any more are kept as room for others. Those of a frame with more, which
/// may be gigabytes, are given up.
inline constexpr std::size_t paths_kept_as_room = 2;

/// What is left of links that nobody needs any more: their room, and that of a few paths.
std::vector<LinkResult> room_of(std::vector<LinkResult>&& links, ThreadPool& pool);

/// By receiver, the transmitters of the links that are asked for, as they come. Throws std::invalid_argument where a
/// number is none of a device.
std::vector<std::vector<std::uint32_t>> requested_links(std::span<const LinkRequest> requests, std::size_t transmitters,
                                                        std::size_t receivers);

/// Numbers ascending, each once.
void sort_and_drop_repeated(std::vector<std::uint32_t>& list);

/// Each of some paths once, as they are reported.
std::vector<PathContribution*> in_order(std::vector<PathContribution>& paths);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/frame_links_bodies.hpp"
#endif
