/// Writes town.obj and town.mtl: a small European town made by rule: bent streets, a main street with a crossing, a
/// square with church and town hall, rows of gabled houses, L-shaped houses, courtyards, remains of a town wall.
/// Every building is a closed shell that stands on the ground without a floor. Usage: make_town FOLDER
#include <iostream>
#include <numbers>

#include "dcem/core/random.hpp"
#include "house_builder.hpp"
#include "scene_writer.hpp"

namespace {

using example::Extra;
using example::Plan;
using example::Profile;
using example::SceneWriter;

constexpr const char* materials =
    R"(# Materials of town.obj. Wall and roof are the paper's outdoor wall: reflection 0.8, nothing passes.
newmtl wall
Kd 0.86 0.80 0.68
em_model constant
em_reflection 0.8
newmtl roof
Kd 0.62 0.27 0.18
em_model constant
em_reflection 0.8
# A half space of concrete (ITU-R P.2040): no thickness, so nothing passes.
newmtl ground
Kd 0.45 0.45 0.45
em_model itu
em_itu concrete
)";

/// A street: the middle line and half the width between the fronts. A square is two very wide streets.
struct Street {
  std::vector<Plan> line;
  double half_width_m;
};

const std::vector<Street> streets{
    {{{-210, -18}, {-120, -6}, {-60, 0}, {0, 2}, {70, 2}, {120, 8}, {210, 26}}, 6.5},             // main street
    {{{-70, -165}, {-64, -88}, {-60, 0}, {-57, 80}, {-66, 165}}, 5.5},                            // crosses it
    {{{112, -165}, {116, -80}, {120, 8}, {126, 98}, {120, 165}}, 5.0},                            // east
    {{{-130, -165}, {-128, -94}, {-121, -6}, {-122, 84}, {-130, 165}}, 4.5},                      // west
    {{{-205, 74}, {-122, 84}, {-57, 80}, {12, 95}, {58, 104}, {126, 98}, {205, 112}}, 4.5},       // north
    {{{-205, -100}, {-128, -94}, {-64, -88}, {0, -80}, {60, -86}, {116, -80}, {205, -84}}, 4.5},  // south
    {{{30, 58}, {33, 98}, {28, 165}}, 4.0},
    {{{38, 2}, {44, -40}, {40, -84}, {34, -165}}, 4.0},
    {{{0, 33}, {60, 33}}, 25.0},  // the square, 60 m x 50 m
    {{{30, 8}, {30, 58}}, 30.0}};

/// A rectangle in the plan that a building or a street keeps for itself.
struct Plot {
  Plan centre, along;  ///< along: unit vector
  double half_length_m, half_depth_m;
};

double extent(const Plot& plot, Plan axis) {
  return std::abs(dot(plot.along, axis)) * plot.half_length_m +
         std::abs(dot(left_of(plot.along), axis)) * plot.half_depth_m;
}

/// Two rectangles overlap unless a direction along one of their sides separates them.
bool overlap(const Plot& a, const Plot& b) {
  for (const Plan axis : {a.along, left_of(a.along), b.along, left_of(b.along)})
    if (std::abs(dot(a.centre - b.centre, axis)) >= extent(a, axis) + extent(b, axis)) return false;
  return true;
}

/// A point or direction in thousandths, so that what is built along it stays exact in the file.
Plan thousandths(Plan a) {
  return {example::snapped(a.x, 0.001), example::snapped(a.y, 0.001)};
}

/// The town as it grows: what is built, and the ground that is taken.
class Town {
 public:
  Town() : scene_(materials) {
    for (const Street& street : streets)
      for (std::size_t i = 0; i + 1 < street.line.size(); ++i) {
        const Plan from = street.line[i], to = street.line[i + 1];
        taken_.push_back({(from + to) * 0.5, unit(to - from), 0.5 * length(to - from), street.half_width_m});
      }
    scene_.object("ground");
    scene_.face("ground", {{-260, -220, 0}, {260, -220, 0}, {260, 220, 0}, {-260, 220, 0}});
  }

  /// Church, town hall and the remains of the town wall: they come first, the houses fill what they leave.
  void add_landmarks() {
    using example::roofed;
    take({{-24, 40}, {1, 0}, 20, 10});
    add_building(scene_, "church_nave", {}, {{-7, 40}, {-38, 40}}, false, roofed(7, 11, 1.3, 0.4, false));
    add_tower(scene_, "church_tower", {-42.2, 40}, 4, 5, 26, 46, std::numbers::pi / 4);
    take({{-42.2, 40}, {1, 0}, 6, 6});
    add_building(scene_, "town_hall", {}, {{69, 20}, {69, 48}}, false, roofed(7, 11, 0.9, 0.5, true),
                 {Extra::chimney, Extra::dormers});
    take({{69, 34}, {0, 1}, 15, 8.5});
    for (const double y : {-30.0, 12.0}) {
      const std::string side = y < 0.0 ? "south" : "north";
      add_tower(scene_, "wall_tower_" + side, {-214, y}, 8, 4.2, 12, 18, 0.4);
      const double far_y = y < 0.0 ? y - 40.0 : y + 40.0;
      add_building(scene_, "town_wall_" + side, {}, {{-214, y + (far_y - y) * 0.125}, {-214, far_y}}, false,
                   roofed(0.6, 5.5, 0.8, 0.2, false));
      take({{-214, 0.5 * (y + far_y)}, {0, 1}, 26, 6});
    }
  }

  void add_fronts() {
    for (const Street& street : streets)
      for (const double side : {1.0, -1.0})
        for (std::size_t i = 0; i + 1 < street.line.size(); ++i)
          add_front(side > 0.0 ? street.line[i] : street.line[i + 1], side > 0.0 ? street.line[i + 1] : street.line[i],
                    street.half_width_m);
  }

  const SceneWriter& scene() const { return scene_; }

 private:
  /// A rectangle with its front on a street: origin in the middle of the front, `along` the front, depth to the left.
  struct Lot {
    Plan origin, along;
    double width_m, depth_m;

    example::Placement placement() const { return {origin.x, origin.y, along.x, along.y}; }
    Plan at(double along_m, double inwards_m) const { return origin + along * along_m + left_of(along) * inwards_m; }
  };

  void take(const Plot& plot) { taken_.push_back(plot); }

  /// Keeps a lot for a building if nothing else is there.
  bool claim(const Lot& lot, double margin_m) {
    const Plot plot{lot.at(0, 0.5 * lot.depth_m), lot.along, 0.5 * lot.width_m + margin_m, 0.5 * lot.depth_m + 0.45};
    for (const Plot& other : taken_)
      if (overlap(plot, other)) return false;
    take(plot);
    return true;
  }

  /// Houses side by side along the left of a stretch of street.
  void add_front(Plan from, Plan to, double half_width_m) {
    const Plan along = thousandths(unit(to - from));
    for (double at_m = 0.0; at_m < length(to - from) - 4.0;) {
      const double kind = random_.uniform(), width_m = draw(9.0, 15.0, 0.2);
      const double used_m = kind < 0.05 ? 28.0 : kind < 0.17 ? 18.0 : kind < 0.76 ? width_m : width_m + 4.6;
      const Plan front = from + along * (at_m + 0.5 * used_m) + left_of(along) * (half_width_m + draw(0.55, 1.2));
      const Lot lot{thousandths(front), along, used_m, kind < 0.05 ? 27.0 : kind < 0.17 ? 17.0 : draw(10.2, 12.6, 0.2)};
      const bool row = kind >= 0.17 && kind < 0.62;
      const bool garden = random_.uniform() < 0.12;
      if (garden)
        at_m += 12.0;
      else if (!claim(lot, row ? 0.14 : 0.6))
        at_m += 1.5;
      else {
        add_house(lot, kind);
        at_m += used_m + (row ? 0.3 : draw(1.3, 3.0));
      }
    }
  }

  void add_house(const Lot& lot, double kind) {
    const std::string name = "house_" + std::to_string(++houses_);
    const double half_m = 0.5 * lot.depth_m, eaves_m = draw(5.6, 9.6), pitch = draw(0.85, 1.2);
    const double a = 0.5 * lot.width_m, d = lot.depth_m;
    if (kind < 0.05)
      add_building(scene_, name, lot.placement(), {{-a + 5, 5}, {a - 5, 5}, {a - 5, d - 5}, {-a + 5, d - 5}}, true,
                   example::roofed(5, eaves_m + 2, 0.8, 0.4, false), {Extra::chimney, Extra::none});
    else if (kind < 0.17)
      add_building(scene_, name, lot.placement(), {{-a, 4.5}, {a - 4.5, 4.5}, {a - 4.5, d}}, false,
                   example::roofed(4.5, eaves_m, pitch, 0.4, kind < 0.1), {Extra::chimney, Extra::none});
    else if (kind < 0.62)
      add_building(scene_, name, lot.placement(), {{-a, half_m}, {a, half_m}}, false,
                   example::roofed(half_m, eaves_m, pitch, 0.4, false), {dormers(0.45), chimney(0.3)});
    else if (kind < 0.76)
      add_building(scene_, name, lot.placement(), {{0, 0}, {0, d}}, false, example::roofed(a, eaves_m, 1.1, 0.4, false),
                   {chimney(0.3), Extra::none});
    else if (kind < 0.88)
      add_building(scene_, name, lot.placement(), {{-a, half_m}, {a, half_m}}, false, example::mansard(half_m, eaves_m),
                   {Extra::none, chimney(0.3)});
    else
      add_building(scene_, name, lot.placement(), {{-a, half_m}, {a, half_m}}, false,
                   example::roofed(half_m, eaves_m, pitch, 0.4, true), {chimney(0.3), Extra::none});
  }

  Extra dormers(double probability) { return random_.uniform() < probability ? Extra::dormers : Extra::none; }
  Extra chimney(double probability) { return random_.uniform() < probability ? Extra::chimney : Extra::none; }

  /// `low` plus a multiple of the step, below `high`.
  double draw(double low, double high, double step = 0.05) {
    return low + step * std::floor(random_.uniform() * (high - low) / step);
  }

  SceneWriter scene_;
  std::vector<Plot> taken_;
  dcem::RandomStream random_{20240917};
  int houses_ = 0;
};

}  // namespace

int main(int argument_count, char** arguments) {
  return example::run_maker(argument_count, arguments, [](const std::filesystem::path& folder) {
    Town town;
    town.add_landmarks();
    town.add_fronts();
    town.scene().write(folder, "town", "A small European town, made by examples/make_town.cpp");
    std::cout << town.scene().object_count() - 1 << " buildings, " << town.scene().triangle_count() << " triangles\n";
  });
}
