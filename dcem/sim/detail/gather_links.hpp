#pragma once
/// The links of all receivers in the order of a frame.
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::detail {

/// Where each link of each receiver stands among all: by transmitter, then receiver.
inline std::vector<std::vector<std::size_t>> places_of(std::span<const std::vector<LinkResult>> by_receiver,
                                                       ThreadPool& pool) {
  std::vector<std::vector<std::size_t>> places(by_receiver.size());
  pool.for_each(by_receiver.size(), [&](std::size_t receiver, unsigned) {
    for (const LinkResult& link : by_receiver[receiver]) places[receiver].push_back(link.transmitter);
  });
  std::vector<std::size_t> next{0};  // by transmitter
  for (const std::vector<std::size_t>& of_one : places) {
    for (const std::size_t transmitter : of_one) {
      if (next.size() < transmitter + 2) next.resize(transmitter + 2);
      ++next[transmitter + 1];
    }
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::vector<std::size_t>& of_one : places) {
    for (std::size_t& place : of_one) place = next[place]++;
  }
  return places;
}

/// From so many links on all threads move them: of ten thousand vehicles they are 100 MB.
inline constexpr std::size_t many_links = 4096;

/// All links by transmitter, then receiver. They are put in the place of those in `room`, where there are any: fresh
/// memory costs more than all else here.
inline std::vector<LinkResult> gather_links(std::vector<std::vector<LinkResult>>&& by_receiver,
                                            std::vector<LinkResult>&& room, ThreadPool& pool) {
  std::size_t count = 0;
  for (const std::vector<LinkResult>& links : by_receiver) count += links.size();
  ThreadPool alone(1);
  ThreadPool& threads = count < many_links ? alone : pool;
  const std::vector<std::vector<std::size_t>> places = places_of(by_receiver, threads);
  std::vector<LinkResult> all = std::move(room);
  all.resize(count);
  threads.for_each(by_receiver.size(), [&](std::size_t receiver, unsigned) {
    std::vector<LinkResult> links = std::move(by_receiver[receiver]);
    for (std::size_t link = 0; link < links.size(); ++link) all[places[receiver][link]] = std::move(links[link]);
  });
  return all;
}

/// What is left of links that nobody needs any more: their room. Their paths are given up by all threads.
inline std::vector<LinkResult> room_of(std::vector<LinkResult>&& links, ThreadPool& pool) {
  if (links.size() < many_links) return {};
  pool.for_each_quick(links.size(), [&](std::size_t link) { links[link] = {}; });
  return std::move(links);
}

}  // namespace dcem::detail
