#pragma once
/// Lines of many links, made by several threads and written in the order of the links. Private to dcem::io.
#include <algorithm>
#include <cstddef>
#include <exception>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/fetch.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// Links that one thread takes at once: so many lines that a look at the next piece costs nothing beside them, so few
/// that all threads end together.
inline std::vector<std::span<const LinkResult>> link_pieces(std::span<const LinkResult> links) {
  constexpr std::size_t least_lines = 256;                         // one for the link itself, one for each path
  constexpr std::size_t many_links = 10'000, links_of_many = 128;  // are not looked at one by one
  std::vector<std::span<const LinkResult>> pieces;
  std::size_t first = 0, lines = 0;
  const auto close = [&](std::size_t beyond) {
    pieces.push_back(links.subspan(first, beyond - first));
    first = beyond;
    lines = 0;
  };
  if (links.size() >= many_links) {
    while (first < links.size()) close(std::min(links.size(), first + links_of_many));
    return pieces;
  }
  for (std::size_t link = 0; link < links.size(); ++link) {
    lines += 1 + links[link].paths.size() + links[link].diffuse.tiles.size();
    if (lines >= least_lines) close(link + 1);
  }
  if (first < links.size()) close(links.size());
  return pieces;
}

/// Calls `visit(link)` for each. Of most links of a fleet there is one path, far from that of the next: it is fetched
/// while those before are told.
template <typename Visit>
void for_each_link(std::span<const LinkResult> links, Visit&& visit) {
  constexpr std::size_t ahead = 6;
  for (std::size_t at = 0; at < links.size(); ++at) {
    if (at + ahead < links.size() && !links[at + ahead].paths.empty()) fetch(links[at + ahead].paths.front());
    visit(links[at]);
  }
}

/// Calls `make(links)` of each piece on the threads of a pool and `take(made)`, with a list of what they made in the
/// order of the pieces, on the calling one. No more pieces are there at a time than keep the threads busy: a frame may
/// bring gigabytes. Of exceptions that of the first piece is thrown.
template <typename Made, typename Make, typename Take>
void in_pieces(ThreadPool& pool, std::span<const LinkResult> links, Make&& make, Take&& take) {
  const std::size_t at_a_time = 64 * std::size_t{pool.size()};
  const std::vector<std::span<const LinkResult>> pieces = link_pieces(links);
  for (std::size_t first = 0; first < pieces.size(); first += at_a_time) {
    std::vector<Made> made(std::min(at_a_time, pieces.size() - first));
    std::vector<std::exception_ptr> failures(made.size());
    pool.for_each(made.size(), [&](std::size_t index, unsigned) {
      try {
        made[index] = make(pieces[first + index]);
      } catch (...) {
        failures[index] = std::current_exception();
      }
    });
    for (const std::exception_ptr& failure : failures) {
      if (failure) std::rethrow_exception(failure);
    }
    take(std::move(made));
  }
}

}  // namespace dcem::io
