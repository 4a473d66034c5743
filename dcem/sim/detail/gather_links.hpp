#pragma once
/// The links of all receivers: in which order threads take them, and in which they stand in a frame.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::detail {

/// From so many links on all threads move them: of ten thousand vehicles they are 100 MB.
inline constexpr std::size_t many_links = 4096;

/// Receivers by how many links they have, most first, so that no thread begins with the longest when all others are
/// done. Where they are very many it does not matter, and they stay in their order.
std::vector<std::size_t> busiest_first(std::size_t receivers,
                                       const std::vector<std::vector<std::uint32_t>>& transmitters_of);

/// All links by transmitter, then receiver. They change places with those in `room`, where there are any: fresh memory
/// costs more than all else here. What has been there is left to the receivers, as room for what they find next.
std::vector<LinkResult> gather_links(std::vector<std::vector<LinkResult>>& by_receiver, std::vector<LinkResult>&& room,
                                     ThreadPool& pool);

/// So many paths of a link that nobody needs any more are kept as room for others. Those of a frame with more, which
/// may be gigabytes, are given up.
inline constexpr std::size_t paths_kept_as_room = 2;

/// What is left of links that nobody needs any more: their room, and that of a few paths.
std::vector<LinkResult> room_of(std::vector<LinkResult>&& links, ThreadPool& pool);

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/gather_links_bodies.hpp"
#endif
