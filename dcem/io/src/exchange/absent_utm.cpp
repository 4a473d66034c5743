// In place of geographiclib_utm.cpp where there is no GeographicLib.
#include <stdexcept>

#include "dcem/io/src/exchange/utm.hpp"

namespace dcem::io {

bool knows_utm() {
  return false;
}

std::string utm_library() {
  throw std::logic_error(std::string(no_utm) + "; expected " + std::string(utm_expected));
}

GeoPlace place_from_utm(const UtmFrame&, double, double) {
  throw std::logic_error(std::string(no_utm) + "; expected " + std::string(utm_expected));
}

}  // namespace dcem::io
