#pragma once
/// Which part of which run a folder holds.
#include <string>

#include "dcem/io/scenario.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::io {

struct ShardFacts {
  ReceiverPart part;
  std::string scenario;  ///< where its file was, from the root
  std::string frames;    ///< "A:B"
  ScenarioOverrides overrides;
};

/// "0/4".
std::string shard_text(const ReceiverPart& part);

}  // namespace dcem::io
