#pragma once
/// Bodies of frame_links.hpp.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/frame_links.hpp"

namespace dcem::detail {

DCEM_INLINE std::vector<std::size_t> busiest_first(LinkLists transmitters_of) {
  constexpr std::size_t very_many = 1024;
  std::vector<std::size_t> order(transmitters_of.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (transmitters_of.size() > very_many) return order;
  std::size_t most = 0;
  for (const std::vector<std::uint32_t>& of_one : transmitters_of) most = std::max(most, of_one.size());
  std::vector<std::size_t> next(most + 2);  // by how many links a receiver has less than the busiest
  for (const std::vector<std::uint32_t>& of_one : transmitters_of) ++next[most - of_one.size() + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t receiver = 0; receiver < transmitters_of.size(); ++receiver) {
    order[next[most - transmitters_of[receiver].size()]++] = receiver;
  }
  return order;
}

/// Counts links of runs of receivers, so that each run then knows the place of its next link with a transmitter. All
/// threads count; one has only a number for each transmitter to go through.
class RunsOfReceivers {
 public:
  RunsOfReceivers(LinkLists transmitters_of, ThreadPool& pool)
      : lists_(transmitters_of), next_(std::min<std::size_t>(transmitters_of.size(), std::max(16U, 4 * pool.size()))) {
    std::size_t transmitters = 0;
    for (const std::vector<std::uint32_t>& of_one : lists_) {
      if (!of_one.empty()) transmitters = std::max<std::size_t>(transmitters, of_one.back() + std::size_t{1});
    }
    pool.for_each(size(), [&](std::size_t run, unsigned) { count(run, transmitters); });
    std::vector<std::size_t> first(transmitters + 1);
    pool.for_each_quick(transmitters, [&](std::size_t transmitter) {
      for (const std::vector<std::size_t>& of_run : next_) first[transmitter + 1] += of_run[transmitter];
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    pool.for_each_quick(transmitters, [&](std::size_t transmitter) {
      std::size_t place = first[transmitter];
      for (std::vector<std::size_t>& of_run : next_) place += std::exchange(of_run[transmitter], place);
    });
  }

  std::size_t size() const { return next_.size(); }
  std::size_t first_receiver(std::size_t run) const { return lists_.size() * run / size(); }
  /// Receivers of a run are to be asked for in their order, once.
  std::size_t next_place(std::size_t run, std::size_t transmitter) { return next_[run][transmitter]++; }

 private:
  void count(std::size_t run, std::size_t transmitters) {
    next_[run].resize(transmitters);
    for (std::size_t receiver = first_receiver(run); receiver < first_receiver(run + 1); ++receiver) {
      for (const std::uint32_t transmitter : lists_[receiver]) ++next_[run][transmitter];
    }
  }

  LinkLists lists_;
  std::vector<std::vector<std::size_t>> next_;  ///< by run and transmitter
};

/// Makes room for so many links, and some more, which all threads touch first: the system clears fresh memory page by
/// page for whoever does.
inline void make_room(std::vector<LinkResult>& links, std::size_t count, ThreadPool& threads) {
  constexpr std::size_t page = 4096, pages_at_once = 64;
  if (links.capacity() >= count) return;
  links = std::vector<LinkResult>();
  links.reserve(count + count / 16);
  auto* const bytes = reinterpret_cast<volatile unsigned char*>(links.data());
  const std::size_t pages = (links.capacity() * sizeof(LinkResult) + page - 1) / page;
  threads.for_each((pages + pages_at_once - 1) / pages_at_once, [&](std::size_t block, unsigned) {
    const std::size_t last = std::min(pages, (block + 1) * pages_at_once);
    for (std::size_t number = block * pages_at_once; number < last; ++number) bytes[number * page] = 0;
  });
}

template <typename Object>
void fetch_to_write(const Object* object) {
  constexpr std::size_t cache_line = 64;
  const char* const bytes = reinterpret_cast<const char*>(object);
  for (std::size_t byte = 0; byte < sizeof(Object); byte += cache_line) __builtin_prefetch(bytes + byte, 1);
}

DCEM_INLINE void LinkSlots::fetch_after(std::size_t index) const {
  constexpr std::size_t links_ahead = 4, paths_ahead = 2;
  if (index + links_ahead < size()) fetch_to_write(&(*this)[index + links_ahead]);
  if (index + paths_ahead >= size()) return;
  const LinkResult& link = (*this)[index + paths_ahead];
  if (!link.paths.empty()) fetch_to_write(link.paths.data());
}

DCEM_INLINE FrameLinks::FrameLinks(LinkLists transmitters_of, std::vector<LinkResult>&& room, ThreadPool& pool)
    : links_(std::move(room)), first_(transmitters_of.size() + 1) {
  for (std::size_t receiver = 0; receiver < transmitters_of.size(); ++receiver) {
    first_[receiver + 1] = first_[receiver] + transmitters_of[receiver].size();
  }
  const std::size_t count = first_.back();
  ThreadPool alone(1);
  ThreadPool& threads = count < many_links ? alone : pool;
  make_room(links_, count, threads);
  links_.resize(count);
  places_ = std::make_unique_for_overwrite<std::uint32_t[]>(count);
  RunsOfReceivers runs(transmitters_of, threads);
  threads.for_each(runs.size(), [&](std::size_t run, unsigned) {
    for (std::size_t receiver = runs.first_receiver(run); receiver < runs.first_receiver(run + 1); ++receiver) {
      std::size_t next = first_[receiver];
      for (const std::uint32_t transmitter : transmitters_of[receiver]) {
        places_[next++] = static_cast<std::uint32_t>(runs.next_place(run, transmitter));
      }
    }
  });
}

DCEM_INLINE LinkSlots FrameLinks::of(std::size_t receiver) {
  const std::size_t first = first_[receiver];
  return {links_.data(), places_.get() + first, first_[receiver + 1] - first};
}

DCEM_INLINE std::vector<LinkResult> room_of(std::vector<LinkResult>&& links, ThreadPool& pool) {
  if (links.size() < many_links) return {};
  constexpr std::size_t at_once = 512;  // most are asked how much they hold, and no more
  const auto look = [&](std::size_t link) {
    const LinkResult& spent = links[link];
    if (spent.paths.capacity() > paths_kept_as_room || !spent.diffuse.tiles.empty()) links[link] = {};
  };
  pool.for_each_quick(links.size(), look, at_once);
  return std::move(links);
}

DCEM_INLINE std::vector<std::vector<std::uint32_t>> requested_links(std::span<const LinkRequest> requests,
                                                                    std::size_t transmitters, std::size_t receivers) {
  std::vector<std::vector<std::uint32_t>> lists(receivers);
  for (const auto& [transmitter, receiver] : requests) {
    if (transmitter >= transmitters || receiver >= receivers) {
      throw std::invalid_argument("solve: a link between devices that are not there");
    }
    lists[receiver].push_back(static_cast<std::uint32_t>(transmitter));
  }
  return lists;
}

DCEM_INLINE void sort_and_drop_repeated(std::vector<std::uint32_t>& list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

DCEM_INLINE std::vector<PathContribution*> in_order(std::vector<PathContribution>& paths) {
  std::vector<PathContribution*> order;
  order.reserve(paths.size());
  for (PathContribution& path : paths) order.push_back(&path);
  std::sort(order.begin(), order.end(), [](const PathContribution* one, const PathContribution* other) {
    return reported_before(one->path, other->path);
  });
  // The same sequence gives the same bits, so repeated paths stand side by side.
  const auto same = [](const PathContribution* one, const PathContribution* other) {
    return same_sequence(one->path, other->path);
  };
  order.erase(std::unique(order.begin(), order.end(), same), order.end());
  return order;
}

}  // namespace dcem::detail
