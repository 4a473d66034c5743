#pragma once
/// Bodies of gather_links.hpp.
#include <algorithm>
#include <functional>
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
  std::vector<std::size_t> links;
  for (const std::vector<std::uint32_t>& of_one : transmitters_of) links.push_back(of_one.size());
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t receiver) { return links[receiver]; });
  return order;
}

/// Where the links of each receiver begin, one after the other, and how many there are in all.
inline std::vector<std::size_t> first_links(std::span<const std::vector<LinkResult>> by_receiver) {
  std::vector<std::size_t> first{0};
  first.reserve(by_receiver.size() + 1);
  for (const std::vector<LinkResult>& links : by_receiver) first.push_back(first.back() + links.size());
  return first;
}

/// Where each link of each receiver, one after the other, stands among all: by transmitter, then receiver.
inline std::vector<std::size_t> places_of(std::span<const std::vector<LinkResult>> by_receiver,
                                          const std::vector<std::size_t>& first, ThreadPool& pool) {
  std::vector<std::size_t> places(first.back());
  pool.for_each(by_receiver.size(), [&](std::size_t receiver, unsigned) {
    std::size_t link = first[receiver];
    for (const LinkResult& one : by_receiver[receiver]) places[link++] = one.transmitter;
  });
  std::vector<std::size_t> next;  // by transmitter
  for (const std::size_t transmitter : places) {
    if (next.size() < transmitter + 2) next.resize(transmitter + 2);
    ++next[transmitter + 1];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t& place : places) place = next[place]++;
  return places;
}

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
  const std::vector<std::size_t> first = first_links(by_receiver);
  ThreadPool alone(1);
  ThreadPool& threads = first.back() < many_links ? alone : pool;
  const std::vector<std::size_t> places = places_of(by_receiver, first, threads);
  std::vector<LinkResult> all = std::move(room);
  const bool has_room = !all.empty();
  make_room(all, first.back(), threads);
  all.resize(first.back());
  threads.for_each(by_receiver.size(), [&](std::size_t receiver, unsigned) {
    std::vector<LinkResult>& links = by_receiver[receiver];
    for (std::size_t link = 0; link < links.size(); ++link) {
      std::swap(all[places[first[receiver] + link]], links[link]);
    }
    if (!has_room) links = {};
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
