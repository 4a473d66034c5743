#pragma once
/// From outlines of houses to blocks that share no wall. Private to dcem::io.
#include <string>
#include <vector>

#include "dcem/io/import.hpp"
#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

/// A house as found: rings that may be dirty, and what it is made of.
struct FoundHouse {
  std::string id;
  std::vector<Ring> outers, inners;
  double height_m = 0.0;
  std::string wall = "wall", roof = "roof";  ///< materials
};

/// A part of the town with one flat roof. Parts that touch have the same corners along their common border.
struct TownPart {
  Areas areas;
  double top_m = 0.0, foot_m = 0.0;  ///< of parts that touch, the feet are at one height
  std::string wall, roof;
  std::string id;  ///< of a house that it is made of
};

/// Cleans outlines; joins what touches; higher wins where houses overlap. The result does not depend on the order of
/// houses but for those of one height. What is repaired and skipped is counted with `noun`: "houses with spikes".
std::vector<TownPart> plan_town(std::vector<FoundHouse>&& houses, const ImportSettings& settings,
                                const std::string& noun, ImportReport& report);

}  // namespace dcem::io
