#pragma once
/// Order statistics of small samples (times per frame, paths per link).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace dcem {

/// The `share` quantile (0…1) by the nearest-rank rule; 0 for an empty sample.
inline double quantile(std::vector<double> sample, double share) {
  if (sample.empty()) return 0.0;
  std::sort(sample.begin(), sample.end());
  const double rank = std::ceil(share * static_cast<double>(sample.size()));
  const auto index = static_cast<std::size_t>(std::clamp(rank - 1.0, 0.0, static_cast<double>(sample.size() - 1)));
  return sample[index];
}

inline double median(std::vector<double> sample) {
  return quantile(std::move(sample), 0.5);
}

inline double mean(const std::vector<double>& sample) {
  double sum = 0.0;
  for (const double value : sample) sum += value;
  return sample.empty() ? 0.0 : sum / static_cast<double>(sample.size());
}

}  // namespace dcem
