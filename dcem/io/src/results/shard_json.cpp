#include "dcem/io/src/results/shard_json.hpp"

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
void read_option(const Json& options, const char* name, std::optional<Value>& value) {
  if (!options.at(name).is_null()) value = options.at(name).get<Value>();
}

}  // namespace

std::string shard_text(const ReceiverPart& part) {
  return std::to_string(part.part) + '/' + std::to_string(part.of);
}

Json shard_json(const ShardFacts& facts) {
  const ScenarioOverrides& given = facts.overrides;
  return {{"part", facts.part.part},
          {"of", facts.part.of},
          {"scenario", facts.scenario},
          {"frames", facts.frames},
          {"options",
           {{"frequency_hz", optional_json(given.frequency_hz)},
            {"discovery", optional_json(given.discovery)},
            {"cache", optional_json(given.cache)},
            {"rays", optional_json(given.rays)},
            {"seed", optional_json(given.seed)},
            {"output", optional_json(given.output)}}}};
}

ShardFacts shard_facts(const Json& shard) {
  ShardFacts facts{{shard.at("part").get<std::uint32_t>(), shard.at("of").get<std::uint32_t>()},
                   shard.at("scenario").get<std::string>(),
                   shard.at("frames").get<std::string>(),
                   {}};
  const Json& options = shard.at("options");
  read_option(options, "frequency_hz", facts.overrides.frequency_hz);
  read_option(options, "discovery", facts.overrides.discovery);
  read_option(options, "cache", facts.overrides.cache);
  read_option(options, "rays", facts.overrides.rays);
  read_option(options, "seed", facts.overrides.seed);
  read_option(options, "output", facts.overrides.output);
  return facts;
}

}  // namespace dcem::io
