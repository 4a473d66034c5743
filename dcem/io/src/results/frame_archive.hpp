#pragma once
/// Results of a frame as bytes and back, to the last bit. For the same program on the same machine: no format to keep.
/// Private to dcem::io.
///
/// Every type names its fields once, for both ways. The names come from structured bindings, which a new field breaks:
/// it cannot be forgotten.
#include <array>
#include <complex>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "dcem/io/summary.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// `Value`, const or not.
template <typename Value, typename Type>
concept IsOf = std::same_as<std::remove_const_t<Value>, Type>;

void fields(auto& archive, IsOf<Vec3> auto& value) {
  archive(value.x, value.y, value.z);
}
template <typename Archive, typename Tag>
void fields(Archive& archive, Id<Tag>& value) {
  archive(value.value);
}
template <typename Archive, typename Tag>
void fields(Archive& archive, const Id<Tag>& value) {
  archive(value.value);
}
void fields(auto& archive, IsOf<ComplexMatrix2> auto& value) {
  archive(value(0, 0), value(0, 1), value(1, 0), value(1, 1));
}
void fields(auto& archive, IsOf<Direction> auto& value) {
  auto& [azimuth_rad, zenith_rad] = value;
  archive(azimuth_rad, zenith_rad);
}
void fields(auto& archive, IsOf<PowerSample> auto& value) {
  auto& [power_ratio, delay_s, doppler_hz, departure, arrival] = value;
  archive(power_ratio, delay_s, doppler_hz, departure, arrival);
}
void fields(auto& archive, IsOf<Interaction> auto& value) {
  auto& [kind, facet, point_m, wedge, in_shadow] = value;
  archive(kind, facet, point_m, wedge, in_shadow);
}
void fields(auto& archive, IsOf<FoliageLength> auto& value) {
  auto& [material, length_m] = value;
  archive(material, length_m);
}
void fields(auto& archive, IsOf<Path> auto& value) {
  auto& [interactions, length_m, foliage] = value;
  archive(interactions, length_m, foliage);
}
void fields(auto& archive, IsOf<PathContribution> auto& value) {
  auto& [path, transfer, amplitude, has_amplitude, ports, transmit_ports, channel, power_ratio, delay_s, doppler_hz,
         departure, arrival] = value;
  archive(path, transfer, amplitude, has_amplitude, ports, transmit_ports, channel, power_ratio, delay_s, doppler_hz,
          departure, arrival);
}
void fields(auto& archive, IsOf<TraversalCounters> auto& value) {
  auto& [nodes_visited, primitives_tested] = value;
  archive(nodes_visited, primitives_tested);
}
void fields(auto& archive, IsOf<DiffuseContribution> auto& value) {
  auto& [sample, amplitude, triangle, place, path, area_m2] = value;
  archive(sample, amplitude, triangle, place, path, area_m2);
}
void fields(auto& archive, IsOf<DiffusePower> auto& value) {
  auto& [tiles, power_ratio, residual_ratio, tiles_evaluated, traversal, converged] = value;
  archive(tiles, power_ratio, residual_ratio, tiles_evaluated, traversal, converged);
}
void fields(auto& archive, IsOf<LinkStatistics> auto& value) {
  auto& [line_of_sight, path_count, power_dbm, incoherent_dbm, los_dbm, reflected_dbm, transmitted_dbm, diffracted_dbm,
         diffuse_dbm, path_gain_db, first_delay_s, mean_delay_s, delay_spread_s, k_factor_db, azimuth_arrival_rad,
         azimuth_departure_rad, zenith_arrival_rad, zenith_departure_rad, mean_doppler_hz, doppler_spread_hz] = value;
  archive(line_of_sight, path_count, power_dbm, incoherent_dbm, los_dbm, reflected_dbm, transmitted_dbm, diffracted_dbm,
          diffuse_dbm, path_gain_db, first_delay_s, mean_delay_s, delay_spread_s, k_factor_db, azimuth_arrival_rad,
          azimuth_departure_rad, zenith_arrival_rad, zenith_departure_rad, mean_doppler_hz, doppler_spread_hz);
}
void fields(auto& archive, IsOf<LinkResult> auto& value) {
  auto& [transmitter, receiver, complete, paths, diffuse, statistics, valid_until_m] = value;
  archive(transmitter, receiver, complete, paths, diffuse, statistics, valid_until_m);
}
void fields(auto& archive, IsOf<LinkRequest> auto& value) {
  auto& [transmitter, receiver] = value;
  archive(transmitter, receiver);
}
void fields(auto& archive, IsOf<TreeUpdateReport> auto& value) {
  auto& [kept, refit, rebuilt, subtrees, root_rebuilt, sah_cost, sah_cost_at_build, reinserted, rotated, in_place] =
      value;
  archive(kept, refit, rebuilt, subtrees, root_rebuilt, sah_cost, sah_cost_at_build, reinserted, rotated, in_place);
}
void fields(auto& archive, IsOf<CacheCounters> auto& value) {
  auto& [taken_over, revalidated, reused, expired, born, died] = value;
  archive(taken_over, revalidated, reused, expired, born, died);
}
void fields(auto& archive, IsOf<WorkCounters> auto& value) {
  auto& [rays, legs, proposed, solved, paths, tiles, unfinished, residual_db, nodes_visited, primitives_tested] = value;
  archive(rays, legs, proposed, solved, paths, tiles, unfinished, residual_db, nodes_visited, primitives_tested);
}
void fields(auto& archive, IsOf<FrameFigures> auto& value) {
  auto& [index, time_s, links, with_line_of_sight, paths, update_time_s, solve_time_s, tree, cache, work] = value;
  archive(index, time_s, links, with_line_of_sight, paths, update_time_s, solve_time_s, tree, cache, work);
}

template <typename Value>
concept PlainValue = std::is_arithmetic_v<Value> || std::is_enum_v<Value>;

/// Appends values to bytes.
class ByteWriter {
 public:
  template <typename... Values>
  void operator()(const Values&... values) {
    (put(values), ...);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <PlainValue Value>
  void put(const Value& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Value));
  }
  void put(const std::complex<double>& value) { (*this)(value.real(), value.imag()); }
  void put(const std::string& text) {
    put(text.size());
    bytes_ += text;
  }
  template <typename Value>
  void put(const std::vector<Value>& values) {
    put(values.size());
    for (const Value& value : values) put(value);
  }
  template <typename Value>
  void put(const std::optional<Value>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  void put(const ChannelMatrix& matrix) {
    (*this)(matrix.rows(), matrix.columns());
    for (std::size_t row = 0; row < matrix.rows(); ++row) {
      for (std::size_t column = 0; column < matrix.columns(); ++column) put(matrix(row, column));
    }
  }
  template <typename Value>
  void put(const Value& value) {
    fields(*this, value);
  }

  std::string bytes_;
};

/// Takes the values back in the same order. Throws std::runtime_error where the bytes end before.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (get(values), ...);
  }

 private:
  std::string_view take(std::size_t size) {
    if (size > rest_.size()) throw std::runtime_error("ends too early");
    const std::string_view piece = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return piece;
  }
  template <PlainValue Value>
  void get(Value& value) {
    std::memcpy(&value, take(sizeof(Value)).data(), sizeof(Value));
  }
  void get(std::complex<double>& value) {
    double real = 0.0, imaginary = 0.0;
    (*this)(real, imaginary);
    value = {real, imaginary};
  }
  std::size_t get_count() {
    std::size_t count = 0;
    get(count);
    if (count > rest_.size()) throw std::runtime_error("ends too early");  // nothing takes less than a byte
    return count;
  }
  void get(std::string& text) { text = take(get_count()); }
  template <typename Value>
  void get(std::vector<Value>& values) {
    values.assign(get_count(), Value{});
    for (Value& value : values) get(value);
  }
  template <typename Value>
  void get(std::optional<Value>& value) {
    bool is_there = false;
    get(is_there);
    value.reset();
    if (is_there) get(value.emplace());
  }
  void get(ChannelMatrix& matrix) {
    const std::size_t rows = get_count(), columns = get_count();
    matrix = rows == 0 ? ChannelMatrix() : ChannelMatrix(rows, columns);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t column = 0; column < columns; ++column) get(matrix(row, column));
    }
  }
  template <typename Value>
  void get(Value& value) {
    fields(*this, value);
  }

  std::string_view rest_;
};

}  // namespace dcem::io
