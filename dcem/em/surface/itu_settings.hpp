#pragma once
/// Which of the ITU's tables of materials counts.

namespace dcem {

/// Which table is used and whether it may be used outside its frequency intervals.
struct ItuSettings {
  int revision = 3;                  ///< 3 or 4
  bool allow_extrapolation = false;  ///< outside the intervals: an error, or the nearest interval's formula
};

}  // namespace dcem
