#pragma once
/// The member `shard` of a summary. Private to dcem::io.
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "dcem/io/shard_facts.hpp"
#include "dcem/io/src/text/json_values.hpp"

namespace dcem::io {

nlohmann::ordered_json shard_json(const ShardFacts& facts);
/// Throws nlohmann::json::exception where it is not what `shard_json` makes.
ShardFacts shard_facts(const nlohmann::ordered_json& shard);

}  // namespace dcem::io
