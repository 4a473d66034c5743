#include <cmath>
#include <cstdio>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/core/units.hpp"
#include "dcem/geometry/aabb.hpp"

#if __cplusplus < 202002L
#error "dcem::dcem must ask for C++20"
#endif

int main() {
  dcem::Aabb<double> box;
  box.extend(dcem::Vector3<double>(3.0, 4.0, 12.0));
  box.extend(dcem::Vector3<double>(0.0));
  std::vector<double> slots(100, 0.0);
  dcem::parallel_for(slots.size(), 2, [&](std::size_t index, unsigned) { slots[index] = 1.0; });  // needs the threads
  double count = 0.0;
  for (const double slot : slots) count += slot;
  const bool right = box.extent() == dcem::Vector3<double>(3.0, 4.0, 12.0) && dcem::power_ratio_to_db(count) == 20.0;
  std::puts(right ? "engine works" : "engine is wrong");
  return right ? 0 : 1;
}
