#pragma once
/// Dots over two axes, joined where they belong together: the delays of paths over time.
///
/// A dot has one colour per trace, so that a trace can be followed, and a size that says how large its value is.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/image.hpp"
#include "dcem/io/picture_format.hpp"

namespace dcem::io {

/// A chart to be drawn.
struct ScatterChart {
  struct Dot {
    double x = 0.0;           ///< in `x_unit`
    double y = 0.0;           ///< in `y_unit`
    double value = 0.0;       ///< in `value_unit`; its size
    std::uint64_t trace = 0;  ///< dots of one trace have one colour (`trace_colour`)
    bool joins_last = false;  ///< a line leads here from the dot of this trace before it in `dots`
    bool is_marked = false;   ///< drawn in black instead
  };

  std::string title;
  std::string x_label = "time", x_unit = "s";
  std::string y_label = "delay", y_unit = "ns";
  std::string value_label = "received power", value_unit = "dBm";
  std::string trace_label = "path";  ///< for the legend: one colour per what
  std::string marked_label{};        ///< for the legend: what a black dot is; empty where none is
  double value_span = 40.0;          ///< from the largest value to that of the smallest dots
  std::vector<Dot> dots{};
};

/// A colour for a trace: six hues of Okabe and Ito (2002), each in four lightnesses, all dark enough for white paper.
/// The same number has the same colour in every picture; neighbouring numbers need not differ.
Colour trace_colour(std::uint64_t trace);

/// Draws the chart, about 1500 × 1000 pixels of the PNG, the largest dots on top. Throws std::invalid_argument without
/// a dot, and for a number that is not finite or beyond ±1e100; `OutputError` also where this build cannot draw.
void write_scatter_chart(const ScatterChart& chart, AtomicFile& file, PictureFormat format);
/// The same into a file that appears only when complete; its ending says the format.
void write_scatter_chart(const ScatterChart& chart, const std::filesystem::path& path);

}  // namespace dcem::io
