#pragma once
/// Where the rays of a packet come from: questions of any kind one after another, or the rays of a fan. Packets are
/// templates over the two, which have the same functions.
#include <algorithm>
#include <cstddef>
#include <span>

#include "dcem/accel/hit_filter.hpp"
#include "dcem/core/instruction_set.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

/// Rays of any kind, each with its filter.
class QueriesInTurn {
 public:
  explicit QueriesInTurn(std::span<const RayQuery> queries) : queries_(queries) {}

  std::size_t size() const { return queries_.size(); }
  const RayQuery& query(std::size_t index) const { return queries_[index]; }
  const Ray<double>& ray(std::size_t index) const { return queries_[index].ray; }
  const HitFilter& filter(std::size_t index) const { return queries_[index].filter; }
  /// Whether the first two begin at one point.
  bool begins_together() const { return size() > 1 && ray(0).origin == ray(1).origin; }
  /// Some of them, as many as there are.
  QueriesInTurn part(std::size_t first, std::size_t most) const {
    return QueriesInTurn(queries_.subspan(first, std::min(most, size() - first)));
  }
  std::span<const std::byte> bytes() const { return std::as_bytes(queries_); }

 private:
  std::span<const RayQuery> queries_;
};

/// The rays of a fan.
class FanInTurn {
 public:
  explicit FanInTurn(const RayFan& fan) : FanInTurn(fan, fan.directions) {}

  std::size_t size() const { return directions_.size(); }
  const Vec3& direction(std::size_t index) const { return directions_[index]; }
  /// Made when it is asked for.
  Ray<double> ray(std::size_t index) const { return {fan_->origin, directions_[index]}; }
  const HitFilter& filter(std::size_t) const { return fan_->filter; }
  bool begins_together() const { return size() > 1; }
  FanInTurn part(std::size_t first, std::size_t most) const {
    return {*fan_, directions_.subspan(first, std::min(most, size() - first))};
  }
  std::span<const std::byte> bytes() const { return std::as_bytes(directions_); }

 private:
  FanInTurn(const RayFan& fan, std::span<const Vec3> directions) : fan_(&fan), directions_(directions) {}

  const RayFan* fan_;
  std::span<const Vec3> directions_;
};

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
