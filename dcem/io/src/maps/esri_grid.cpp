#include "dcem/io/esri_grid.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/src/text/sheet.hpp"

namespace dcem::io {
namespace {

template <typename Number>
void append_key(std::string& text, const char* key, Number value) {
  text += key;
  text += ' ';
  append_number(text, value);
  text += '\n';
}

std::string grid_header(const ReceiverGrid& grid) {
  std::string text;
  append_key(text, "ncols", grid.columns());
  append_key(text, "nrows", grid.rows());
  append_key(text, "xllcenter", grid.origin_m.x);
  append_key(text, "yllcenter", grid.origin_m.y);
  if (grid.spacing_m[0] == grid.spacing_m[1]) {
    append_key(text, "cellsize", grid.spacing_m[0]);
  } else {
    append_key(text, "dx", grid.spacing_m[0]);
    append_key(text, "dy", grid.spacing_m[1]);
  }
  append_key(text, "NODATA_value", esri_no_value);
  return text;
}

}  // namespace

void write_esri_grid(AtomicFile& file, const ReceiverGrid& grid, std::span<const double> values) {
  if (values.size() != grid.size()) throw std::invalid_argument("write_esri_grid: expected one value per grid point");
  std::string text = grid_header(grid);
  for (std::size_t row = grid.rows(); row-- > 0;) {
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      const double value = values[row * grid.columns() + column];
      if (column > 0) text += ' ';
      append_number(text, std::isfinite(value) ? value : esri_no_value);
      if (text.size() >= sheet_bytes) file.write(std::exchange(text, {}));
    }
    text += '\n';
  }
  file.write(text);
}

}  // namespace dcem::io
