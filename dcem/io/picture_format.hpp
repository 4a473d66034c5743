#pragma once
/// What a picture is written as, and what this build can draw with.
///
/// Pictures are drawn with Cairo, from the same code for every format. A build without it writes maps as plain rasters
/// (PNG, without axes and text) and no charts at all.
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace dcem::io {

enum class PictureFormat {
  png,  ///< with twice as many pixels as the other two are long in px
  svg,  ///< texts are outlines, so that they look the same everywhere
  pdf   ///< one page, as large as the picture
};

/// The formats that were asked for; absent: the usual one of each kind of picture, PNG for maps and SVG for charts.
using PictureFormats = std::optional<std::vector<PictureFormat>>;

/// "png", "svg" or "pdf": the word of a scenario, and the ending of a file without its dot.
std::string_view word_of(PictureFormat format);

/// The format of that word; nothing for any other.
std::optional<PictureFormat> picture_format(std::string_view word);

/// The format that a file's ending says. Throws std::invalid_argument for an ending that is none.
PictureFormat picture_format_of(const std::filesystem::path& file);

/// The formats that are wanted of a picture whose usual one is `usual`.
std::vector<PictureFormat> formats_or(const PictureFormats& formats, PictureFormat usual);

/// Whether this build has Cairo.
bool can_draw();

/// "Cairo 1.16.0", or that there is none.
std::string drawing_library();

/// What is said where a picture is wanted that this build cannot draw, and what was expected.
inline constexpr std::string_view no_drawing = "this build draws no charts";
inline constexpr std::string_view drawing_expected = "Cairo (libcairo2-dev) when DCEM was built";

}  // namespace dcem::io
