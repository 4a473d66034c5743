#pragma once
/// Bodies of gather_links.hpp.
#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/gather_links.hpp"

namespace dcem::detail {

DCEM_INLINE std::vector<std::size_t> busiest_first(std::size_t receivers,
                                                   const std::vector<std::vector<std::uint32_t>>& transmitters_of) {
  constexpr std::size_t very_many = 1024;
  std::vector<std::size_t> order(receivers);
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (transmitters_of.size() != receivers || receivers > very_many) return order;
  std::size_t most = 0;
  for (const std::vector<std::uint32_t>& of_one : transmitters_of) most = std::max(most, of_one.size());
  std::vector<std::size_t> next(most + 2);  // by how many links a receiver has less than the busiest
  for (const std::vector<std::uint32_t>& of_one : transmitters_of) ++next[most - of_one.size() + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t receiver = 0; receiver < receivers; ++receiver) {
    order[next[most - transmitters_of[receiver].size()]++] = receiver;
  }
  return order;
}

/// Where the links of receivers stand among all, by transmitter, then receiver. Each of several runs of receivers
/// counts its own: then one thread has only these counts to go through.
class LinkPlaces {
 public:
  LinkPlaces(std::span<const std::vector<LinkResult>> by_receiver, ThreadPool& pool)
      : by_receiver_(by_receiver), next_(std::min<std::size_t>(by_receiver.size(), std::max(16U, 4 * pool.size()))) {
    pool.for_each(runs(), [&](std::size_t run, unsigned) { count(run); });
    turn_counts_into_places();
  }

  std::size_t runs() const { return next_.size(); }
  std::size_t first_receiver(std::size_t run) const { return by_receiver_.size() * run / runs(); }
  /// The place of the next link with a transmitter: receivers of a run are to be asked for in their order, once.
  std::size_t next(std::size_t run, std::size_t transmitter) { return next_[run][transmitter]++; }

 private:
  void count(std::size_t run) {
    std::vector<std::size_t>& of_transmitter = next_[run];
    for (std::size_t receiver = first_receiver(run); receiver < first_receiver(run + 1); ++receiver) {
      for (const LinkResult& link : by_receiver_[receiver]) {
        if (of_transmitter.size() <= link.transmitter) of_transmitter.resize(link.transmitter + 1);
        ++of_transmitter[link.transmitter];
      }
    }
  }

  void turn_counts_into_places() {
    std::size_t transmitters = 0, links = 0;
    for (const std::vector<std::size_t>& of_run : next_) transmitters = std::max(transmitters, of_run.size());
    for (std::size_t transmitter = 0; transmitter < transmitters; ++transmitter) {
      for (std::vector<std::size_t>& of_run : next_) {
        if (transmitter < of_run.size()) links += std::exchange(of_run[transmitter], links);
      }
    }
  }

  std::span<const std::vector<LinkResult>> by_receiver_;
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

DCEM_INLINE std::vector<LinkResult> gather_links(std::vector<std::vector<LinkResult>>& by_receiver,
                                                 std::vector<LinkResult>&& room, ThreadPool& pool) {
  std::size_t count = 0;
  for (const std::vector<LinkResult>& links : by_receiver) count += links.size();
  ThreadPool alone(1);
  ThreadPool& threads = count < many_links ? alone : pool;
  LinkPlaces places(by_receiver, threads);
  std::vector<LinkResult> all = std::move(room);
  const bool has_room = !all.empty();
  make_room(all, count, threads);
  all.resize(count);
  threads.for_each(places.runs(), [&](std::size_t run, unsigned) {
    for (std::size_t receiver = places.first_receiver(run); receiver < places.first_receiver(run + 1); ++receiver) {
      std::vector<LinkResult>& links = by_receiver[receiver];
      for (LinkResult& link : links) std::swap(all[places.next(run, link.transmitter)], link);
      if (!has_room) links = {};
    }
  });
  return all;
}

DCEM_INLINE std::vector<LinkResult> room_of(std::vector<LinkResult>&& links, ThreadPool& pool) {
  if (links.size() < many_links) return {};
  pool.for_each_quick(links.size(), [&](std::size_t link) {
    const LinkResult& spent = links[link];
    if (spent.paths.capacity() > paths_kept_as_room || !spent.diffuse.tiles.empty()) links[link] = {};
  });
  return std::move(links);
}

}  // namespace dcem::detail
