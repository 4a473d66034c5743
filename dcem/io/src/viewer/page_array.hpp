#pragma once
/// Numbers of the page: arrays of little-endian values as base64. Private to dcem::io.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/atomic_file.hpp"

namespace dcem::io {

class PageArray {
 public:
  void add(std::uint32_t value) { append(value, 4); }
  void add(float value);
  void add(double value);
  /// Three numbers in single precision.
  void add(const Vec3& point);
  /// Single precision; what is absent or not finite is NaN, always the same one.
  void number(const std::optional<double>& value);

  void write(AtomicFile& file, std::string_view name, std::string_view type) const;

 private:
  void append(std::uint64_t bits, int count);

  std::string bytes_;
};

/// The arrays of a part of the page, by name. Those that are announced are there, also where nothing comes to stand in
/// them.
class PageArrays {
 public:
  void announce(std::initializer_list<const char*> counts, std::initializer_list<const char*> numbers);
  PageArray& counts(std::string_view name) { return array(name, "u32"); }
  PageArray& numbers(std::string_view name) { return array(name, "f32"); }
  PageArray& instants(std::string_view name) { return array(name, "f64"); }

  void write(AtomicFile& file) const;

 private:
  struct Entry {
    std::string_view type;
    PageArray array;
  };
  PageArray& array(std::string_view name, std::string_view type);

  std::map<std::string, Entry, std::less<>> arrays_;
};

/// Gives each text a number, in the order in which they come.
template <typename Key>
class Numbering {
 public:
  std::uint32_t of(const Key& key) {
    const auto [place, is_new] = numbers_.try_emplace(key, static_cast<std::uint32_t>(keys_.size()));
    if (is_new) keys_.push_back(key);
    return place->second;
  }
  const std::vector<Key>& keys() const { return keys_; }

 private:
  std::map<Key, std::uint32_t> numbers_;
  std::vector<Key> keys_;
};

}  // namespace dcem::io
