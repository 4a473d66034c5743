#pragma once
/// The tables themselves. Private to dcem::io.
#include "dcem/io/src/scenario/keys/key_rules.hpp"

namespace dcem::io::keys {

/// The scenario as a whole; all other blocks hang from it.
const BlockRule& scenario_block();
/// What the command line may override: the options, with the rules of the keys that they stand for.
const BlockRule& command_line_block();

const BlockRule& object_block();
const BlockRule& motion_block();
const BlockRule& transmitter_block();
const BlockRule& receiver_block();
const BlockRule& antenna_block();
const BlockRule& propagation_block();
const BlockRule& output_block();
/// The keys of `output` for files that other programs read.
std::vector<KeyRule> exchange_keys();
const BlockRule& geo_block();
const BlockRule& material_block();

}  // namespace dcem::io::keys
