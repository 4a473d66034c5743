#pragma once
/// What most files of dcem::io parse anyway, parsed once. That every file includes what it uses is checked elsewhere
/// (target headers_alone).
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "dcem/channel/radio_map.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/settings.hpp"
