#pragma once
/// The arrays of a map over [row, column] or [point], collected for an NPZ file. Private to dcem::io.
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/channel/radio_map.hpp"
#include "dcem/io/npz_writer.hpp"

namespace dcem::io {

/// `Point` has `position_m`. Each `add` takes a function from a point to its value; the coordinates come first of all.
/// Archives of maps are packed: neighbouring values share most of their bytes, and empty ones all.
template <typename Point>
class MapArrays {
 public:
  /// The points outlive the arrays.
  MapArrays(const MapPlaces& places, std::span<const Point> points)
      : shape_(places.shape()), points_(points), writer_(NpzCompression::deflate) {
    add_numbers("x_m", [](const Point& point) { return std::optional(point.position_m.x); });
    add_numbers("y_m", [](const Point& point) { return std::optional(point.position_m.y); });
    add_numbers("z_m", [](const Point& point) { return std::optional(point.position_m.z); });
  }
  MapArrays(const MapPlaces& places, const std::vector<Point>& points)
      : MapArrays(places, std::span<const Point>(points)) {}

  /// Absent values are NaN.
  template <typename Value>
  void add_numbers(const std::string& name, Value&& value) {
    std::vector<double> values;
    values.reserve(points_.size());
    for (const Point& point : points_) {
      values.push_back(value(point).value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    writer_.add(name, shape_, values);
  }

  template <typename Value>
  void add_flags(const std::string& name, Value&& value) {
    std::vector<bool> values;
    values.reserve(points_.size());
    for (const Point& point : points_) values.push_back(value(point));
    writer_.add(name, shape_, values);
  }

  template <typename Value>
  void add_counts(const std::string& name, Value&& value) {
    std::vector<std::uint32_t> values;
    values.reserve(points_.size());
    for (const Point& point : points_) values.push_back(static_cast<std::uint32_t>(value(point)));
    writer_.add(name, shape_, std::span<const std::uint32_t>(values));
  }

  template <typename Value>
  void add_texts(const std::string& name, Value&& value) {
    std::vector<std::string> values;
    values.reserve(points_.size());
    for (const Point& point : points_) values.push_back(value(point));
    writer_.add(name, shape_, std::span<const std::string>(values));
  }

  NpzWriter& writer() { return writer_; }

 private:
  NpzWriter::Shape shape_;
  std::span<const Point> points_;
  NpzWriter writer_;
};

}  // namespace dcem::io
