#include "dcem/io/src/scenario/known_formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "dcem/io/input_error.hpp"

namespace dcem::io {

namespace {

/// What tells a file, and what is said of it.
struct KnownFormat {
  std::string_view sign;  ///< an ending, or a piece of the text
  std::string_view is;
  std::string_view names_it;  ///< how a scenario does that; empty: not at all
};

constexpr std::array<KnownFormat, 8> by_ending{{
    {".obj", "an OBJ, a scene", "under scene.obj"},
    {".mtl", "an MTL, the materials of an OBJ", "in the OBJ under scene.obj"},
    {".msi", "an antenna pattern (MSI)", "under antenna.pattern.msi"},
    {".nsm", "an antenna pattern (NSMA)", "under antenna.pattern.msi"},
    {".gz", "a compressed file", "under mobility.sumo_fcd where it is a trace"},
    {".npz", "a result (NPZ)", ""},
    {".png", "a picture (PNG)", ""},
    {".csv", "a table (CSV)", "under poses_csv, points_csv or antenna.pattern.csv"},
}};

/// Of XML; the last fits any.
constexpr std::array<KnownFormat, 5> by_element{{
    {"<fcd-export", "SUMO's FCD output, a trace", "under mobility.sumo_fcd"},
    {"<additional", "an additional file of SUMO", "under mobility.vehicle_types where it holds them"},
    {"<routes", "a route file of SUMO", "under mobility.vehicle_types where it holds them"},
    {"<net", "a road network of SUMO", ""},
    {"<", "XML", "under mobility.sumo_fcd or mobility.vehicle_types where it is of SUMO"},
}};

[[noreturn]] void refuse(const std::filesystem::path& file, const KnownFormat& format) {
  const std::string names_it = format.names_it.empty() ? "" : " that names it " + std::string(format.names_it);
  throw InputError(file.string(), "this is " + std::string(format.is) + "; expected a scenario (JSON)" + names_it);
}

}  // namespace

void refuse_known_format(const std::filesystem::path& file, const std::string& text) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return std::tolower(letter); });
  for (const KnownFormat& format : by_ending) {
    if (ending == format.sign) refuse(file, format);
  }
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || text[first] != '<') return;
  constexpr std::size_t beginning = 4096;  // behind comments that a program may have put there
  for (const KnownFormat& format : by_element) {
    if (text.substr(0, beginning).find(format.sign) != std::string::npos) refuse(file, format);
  }
}

}  // namespace dcem::io
