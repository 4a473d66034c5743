#pragma once
/// The span of a scale.

namespace dcem::io {

/// The lowest and the highest value of a colour bar.
struct ValueRange {
  double low = 0.0;
  double high = 1.0;
};

}  // namespace dcem::io
