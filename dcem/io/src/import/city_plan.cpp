#include "dcem/io/src/import/city_plan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "dcem/io/src/import/outline_cleaning.hpp"
#include "dcem/io/src/import/plan_corners.hpp"

namespace dcem::io {

namespace {

/// Pieces of the plane with the house that stands there.
struct Ground {
  std::vector<PlanePiece> pieces;
  std::vector<std::optional<std::size_t>> house;  ///< by piece: the highest
};

class TownPlanner {
 public:
  TownPlanner(std::vector<FoundHouse>&& houses, const ImportSettings& settings, const std::string& noun,
              ImportReport& report)
      : houses_(std::move(houses)), settings_(settings), noun_(noun), report_(report) {}

  std::vector<TownPart> plan() {
    clean();
    drop_repeated();
    const std::size_t moved = snap_outlines(outlines_, settings_.snap_tolerance_m);
    count(report_.repaired, " snapped to their neighbours", moved);
    Ground ground = stand_houses();
    part_touching_corners(ground);
    return parts_of(ground);
  }

 private:
  void count(ImportReport::Counts& counts, const std::string& what, std::size_t times = 1) const {
    if (times > 0) counts[noun_ + what] += times;
  }

  void clean() {
    std::vector<FoundHouse> kept;
    for (FoundHouse& house : houses_) {
      if (!clean_rings(house)) continue;
      ShapedOutline shaped;
      try {
        shaped = shape_outline(house.outers, house.inners);
      } catch (const std::runtime_error&) {
        count(report_.skipped, " whose outline cannot be mended");
        continue;
      }
      if (area_m2(shaped.areas) < settings_.smallest_house_m2) {
        count(report_.skipped, " without area");
        continue;
      }
      if (shaped.was_crossed) count(report_.repaired, " whose outline crosses itself");
      outlines_.push_back(std::move(shaped.areas));
      kept.push_back(std::move(house));
    }
    houses_ = std::move(kept);
  }

  /// False where no ring is left.
  bool clean_rings(FoundHouse& house) const {
    bool had_repeats = false, had_spikes = false;
    for (std::vector<Ring>* const rings : {&house.outers, &house.inners}) {
      for (Ring& ring : *rings) {
        const RingCleaning cleaning = clean_ring(ring);
        had_repeats = had_repeats || cleaning.had_repeats;
        had_spikes = had_spikes || cleaning.had_spikes;
      }
      std::erase_if(*rings, [](const Ring& ring) { return ring.size() < 3; });
    }
    if (house.outers.empty()) {
      count(report_.skipped, " with fewer than three corners");
      return false;
    }
    if (had_repeats) count(report_.repaired, " with repeated corners");
    if (had_spikes) count(report_.repaired, " with spikes");
    return true;
  }

  /// The same outline twice is one house, the higher one.
  void drop_repeated() {
    std::map<std::vector<std::pair<double, double>>, std::size_t> seen;
    std::vector<FoundHouse> kept;
    std::vector<Areas> kept_outlines;
    for (std::size_t index = 0; index < houses_.size(); ++index) {
      const auto [place, is_new] = seen.emplace(corners_of(outlines_[index]), kept.size());
      if (!is_new) {
        count(report_.skipped, " there already");
        if (houses_[index].height_m > kept[place->second].height_m) kept[place->second] = std::move(houses_[index]);
        continue;
      }
      kept.push_back(std::move(houses_[index]));
      kept_outlines.push_back(std::move(outlines_[index]));
    }
    houses_ = std::move(kept);
    outlines_ = std::move(kept_outlines);
  }

  static std::vector<std::pair<double, double>> corners_of(const Areas& areas) {
    std::vector<std::pair<double, double>> corners;
    for (const Area& area : areas) {
      for (const Vec2& corner : area.outer) corners.emplace_back(corner.x, corner.y);
      for (const Ring& hole : area.holes) {
        for (const Vec2& corner : hole) corners.emplace_back(corner.x, corner.y);
      }
    }
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  Ground stand_houses() {
    Ground ground{cut_plane(outlines_), {}};
    std::set<std::size_t> overlapping;
    for (const PlanePiece& piece : ground.pieces) {
      ground.house.push_back(highest(piece.inside_of));
      if (piece.inside_of.size() > 1 && !is_thin(piece.area)) {
        overlapping.insert(piece.inside_of.begin(), piece.inside_of.end());
      }
    }
    overlapping_ = overlapping.size();
    close_gaps(ground);
    return ground;
  }

  std::optional<std::size_t> highest(const std::vector<std::size_t>& candidates) const {
    if (candidates.empty()) return std::nullopt;
    return *std::max_element(candidates.begin(), candidates.end(),
                             [&](std::size_t a, std::size_t b) { return houses_[a].height_m < houses_[b].height_m; });
  }

  bool is_thin(const Area& area) const { return 2.0 * area_m2(area) < settings_.snap_tolerance_m * perimeter_m(area); }

  /// A slit between houses that is closed all around, or a sliver that two of them claim, belongs to the neighbour with
  /// the longest common border.
  void close_gaps(Ground& ground) {
    const PlanCorners corners(ground.pieces);
    const std::vector<std::optional<std::size_t>> before = ground.house;
    gaps_ = 0;
    for (std::size_t piece = 0; piece < ground.pieces.size(); ++piece) {
      if (!is_thin(ground.pieces[piece].area)) continue;
      const std::optional<std::size_t> neighbour = corners.longest_neighbour(
          piece, [&](std::size_t other) { return before[other].has_value() && !is_thin(ground.pieces[other].area); });
      if (!neighbour) continue;
      if (!before[piece]) ++gaps_;
      ground.house[piece] = before[*neighbour];
    }
  }

  double height_m(const Ground& ground, std::optional<std::size_t> piece) const {
    if (!piece || !ground.house[*piece]) return 0.0;
    return houses_[*ground.house[*piece]].height_m;
  }

  /// Where houses meet in a corner alone, four walls would share one edge: each of them gives up a few centimetres.
  void part_touching_corners(Ground& ground) {
    constexpr int most_rounds = 4;
    constexpr double parted_m = 0.05;
    std::size_t parted = 0;
    for (int round = 0; round <= most_rounds; ++round) {
      const PlanCorners corners(ground.pieces);
      const std::vector<Vec2> points_m =
          corners.pinches([&](std::optional<std::size_t> piece) { return height_m(ground, piece); });
      if (points_m.empty()) break;
      if (round == most_rounds) {
        report_.notes.push_back(std::to_string(points_m.size()) + " corners of " + noun_ +
                                " still touch in a point: four walls share an edge there");
        break;
      }
      parted += points_m.size();
      part_corners(outlines_, points_m, parted_m * (1.0 + round));
      ground = stand_houses();
    }
    count(report_.repaired, ": corners that touched in a point, parted", parted);
    count(report_.repaired, ": gaps narrower than the tolerance, closed", gaps_);
    count(report_.repaired, " that overlap, the higher kept there", overlapping_);
  }

  /// Pieces by what they become one part with.
  std::vector<TownPart> parts_of(const Ground& ground) const {
    using Kind = std::tuple<double, std::string, std::string, std::size_t>;
    std::map<Kind, std::vector<Area>> kinds;
    std::map<Kind, std::size_t> house_of;
    for (std::size_t piece = 0; piece < ground.pieces.size(); ++piece) {
      if (!ground.house[piece]) continue;
      const std::size_t index = *ground.house[piece];
      const FoundHouse& house = houses_[index];
      const bool is_own = settings_.touching == TouchingHouses::snap;
      const Kind kind{house.height_m, house.wall, house.roof, is_own ? index : 0};
      kinds[kind].push_back(ground.pieces[piece].area);
      house_of.emplace(kind, index);
    }
    std::vector<TownPart> parts;
    for (const auto& [kind, pieces] : kinds) {
      const FoundHouse& house = houses_[house_of.at(kind)];
      for (Area& area : unite_pieces(pieces)) {
        parts.push_back({{std::move(area)}, house.height_m, 0.0, house.wall, house.roof, house.id});
      }
    }
    return parts;
  }

  std::vector<FoundHouse> houses_;
  std::vector<Areas> outlines_;  ///< by house
  const ImportSettings& settings_;
  std::string noun_;
  ImportReport& report_;
  std::size_t gaps_ = 0, overlapping_ = 0;
};

}  // namespace

std::vector<TownPart> plan_town(std::vector<FoundHouse>&& houses, const ImportSettings& settings,
                                const std::string& noun, ImportReport& report) {
  return TownPlanner(std::move(houses), settings, noun, report).plan();
}

}  // namespace dcem::io
