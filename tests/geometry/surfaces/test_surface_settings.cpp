#include <doctest/doctest.h>

#include "dcem/geometry/surfaces/surface_settings.hpp"

namespace test_surface_settings {

TEST_CASE("the tolerances are those of the conventions: 0.1 mm and 1 mm") {
  const dcem::SurfaceSettings settings;
  CHECK(settings.weld_tolerance_m == 1e-4);
  CHECK(settings.planarity_tolerance_m == 1e-3);
}

}  // namespace test_surface_settings
