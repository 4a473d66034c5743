#pragma once
/// Receivers and cars that move straight through the streets of a city, and a mast: made from the city alone.
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dcem/accel/wide_index.hpp"
#include "dcem/core/random.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::bench {

/// Places under the open sky, and ways along which nothing stands.
class Streets {
 public:
  Streets(const Scene& scene, const WideIndex& index, const Vec3& around_m, double within_m)
      : index_(index), around_m_(around_m), within_m_(within_m) {
    for (const Vec3& vertex : scene.vertices_m()) bounds_m_.extend(vertex);
  }

  /// A place so high over the ground.
  Vec3 place(double height_m) {
    for (;;) {
      const Vec3 above(around_m_.x + within_m_ * (2.0 * random_.uniform() - 1.0),
                       around_m_.y + within_m_ * (2.0 * random_.uniform() - 1.0), bounds_m_.max.z + 1.0);
      const auto ground = index_.closest_hit({above, Vec3(0.0, 0.0, -1.0)}, {}, nullptr);
      if (ground && above.z - ground->t < bounds_m_.min.z + 0.5)
        return {above.x, above.y, above.z - ground->t + height_m};
    }
  }

  struct Way {
    Vec3 from_m, ahead;
    double yaw_rad;
  };
  /// A level way of a length, with room on both sides.
  Way way(double height_m, double length_m, double half_width_m) {
    for (;;) {
      const Vec3 from_m = place(height_m);
      for (int attempt = 0; attempt < 16; ++attempt) {
        const double yaw_rad = 2.0 * pi * random_.uniform();
        const Vec3 ahead(std::cos(yaw_rad), std::sin(yaw_rad), 0.0), aside(-ahead.y, ahead.x, 0.0);
        bool is_free = true;
        for (const double across_m : {-half_width_m, 0.0, half_width_m}) {
          const Vec3 start_m = from_m + across_m * aside - 3.0 * ahead;
          is_free =
              is_free && !index_.occluded(segment_between(start_m, start_m + (length_m + 6.0) * ahead), {}, nullptr);
        }
        if (is_free) return {from_m, ahead, yaw_rad};
      }
    }
  }

 private:
  const WideIndex& index_;
  Vec3 around_m_;
  double within_m_;
  Aabb<double> bounds_m_;
  RandomStream random_{7};
};

struct DriveOrder {
  std::string file;  ///< OBJ
  Vec3 mast_m{0.0};
  bool mast_drives = false;                          ///< the transmitter moves like a receiver instead …
  std::optional<double> mast_step_m = std::nullopt;  ///< … but so far from frame to frame
  double within_m = 150.0;                           ///< of the mast, along both axes
  double step_m = 0.14;                              ///< of receivers, from frame to frame
  std::size_t receivers = 1, cars = 0, frames = 40;
  double car_step_m = 1.0;
  std::size_t column = 1;  ///< so many receivers drive one behind the other …
  double gap_m = 20.0;     ///< … at this distance
};

/// The motions hold from time 0 on, a second for a frame.
inline Scene street_drive(const DriveOrder& order) {
  const TriangleMesh mesh = io::read_obj(order.file).mesh;
  Scene scene;
  for (const std::string& name : mesh.material_names) scene.add_material({name, ItuMaterial{"concrete", std::nullopt}});
  scene.add_material({"car", PerfectConductor{}});
  scene.set_scenery(mesh);
  WideIndex index;
  index.build(scene.triangle_view(), scene.triangle_boxes(), scene.first_triangles());
  Streets streets(scene, index, order.mast_m, order.within_m);
  const auto way_of = [&](double height_m, double step_m, double longer_m) {
    return streets.way(height_m, step_m * static_cast<double>(order.frames) + longer_m, 0.3);
  };
  const auto driving = [](const std::string& id, const Streets::Way& way, double ahead_m, double step_m) {
    const Vec3 from_m = way.from_m + ahead_m * way.ahead;
    Device device = device_at(id, from_m, 30.0);
    device.motion = LinearMotion{{from_m}, step_m * way.ahead, 0.0};
    return device;
  };
  const double mast_step_m = order.mast_step_m.value_or(order.step_m);
  scene.add_transmitter(order.mast_drives ? driving("sender", way_of(1.6, mast_step_m, 0.0), 0.0, mast_step_m)
                                          : device_at("mast", order.mast_m, 30.0));
  Streets::Way way{};
  const double column_m = order.gap_m * static_cast<double>(order.column - 1);
  for (std::size_t number = 0; number < order.receivers; ++number) {
    const std::size_t place = number % order.column;
    if (place == 0) way = way_of(1.5, order.step_m, column_m);
    const double ahead_m = column_m - order.gap_m * static_cast<double>(place);
    scene.add_receiver(driving("receiver" + std::to_string(number), way, ahead_m, order.step_m));
  }
  TriangleMesh box;
  const Vec3 low_m(-2.2, -0.9, 0.0), high_m(2.2, 0.9, 1.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side_m : {low_m[axis], high_m[axis]}) {
      std::array<Vec3, 4> corners_m;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (std::size_t corner = 0; corner < 4; ++corner) {
        corners_m[corner][axis] = side_m;
        corners_m[corner][u] = corner == 1 || corner == 2 ? high_m[u] : low_m[u];
        corners_m[corner][v] = corner >= 2 ? high_m[v] : low_m[v];
      }
      add_quad(box, corners_m, "car");
    }
  }
  for (std::size_t number = 0; number < order.cars; ++number) {
    const auto car_way = streets.way(0.02, order.car_step_m * static_cast<double>(order.frames), 1.2);
    scene.add_object("car" + std::to_string(number), box,
                     LinearMotion{{car_way.from_m, car_way.yaw_rad, 0.0, 0.0}, order.car_step_m * car_way.ahead, 0.0});
  }
  return scene;
}

}  // namespace dcem::bench
