#pragma once
/// Sequences by numbers.
#include <cstddef>
#include <initializer_list>

#include "dcem/paths/sequence.hpp"

namespace dcem::test {

/// Mirrors, from the receiver outwards.
inline Sequence over(std::initializer_list<std::size_t> mirrors) {
  Sequence sequence;
  for (const std::size_t mirror : mirrors) sequence.emplace_back(FacetId(mirror));
  return sequence;
}

}  // namespace dcem::test
