#pragma once
/// Two cuts of an antenna pattern, and the table that is made of them. Private to dcem::io.
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/em/antenna/pattern_table.hpp"

namespace dcem::io {

/// Attenuation over one turn, linear in dB between its points.
class PatternCut {
 public:
  /// A point as it stands in the file.
  struct Point {
    double angle_deg = 0.0;
    double attenuation_db = 0.0;
    std::size_t line = 0;
  };

  /// `name` is the file, `cut` what messages call this cut, `points` in any order. Throws InputError where a direction
  /// is there twice (a last point one turn after the first may repeat it) or a gap is wider than 90°.
  PatternCut(const std::string& name, const std::string& cut, std::vector<Point> points);

  double attenuation_db(double angle_deg) const;
  /// The coarsest of 1, 0.5, 0.25 and 0.1° in which every point has a place, or else 0.1°.
  double step_deg() const;

 private:
  std::vector<Point> points_;  ///< angles in [0, 360), ascending
};

/// The table of two cuts: `horizontal` counted clockwise from the boresight, `vertical` downwards from the horizon. How
/// the gain between them is found is in antenna_files.hpp.
PatternTable table_from_cuts(double gain_dbi, const PatternCut& horizontal, const PatternCut& vertical);

}  // namespace dcem::io
