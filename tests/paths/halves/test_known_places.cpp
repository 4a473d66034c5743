/// Places that one device has come into and another takes over; and work that is spread over frames.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/halves/known_places.hpp"
#include "dcem/paths/halves/spread_work.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_known_places {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Nobody has looked from it yet.
std::shared_ptr<const Place> place_at(const PlaceBox& box, bool over_mirrors = false) {
  return std::make_shared<const Place>(box, over_mirrors);
}

/// How far a point gets until it comes out of a box, to half a millimetre: step by step.
double walked_out_m(const PlaceBox& box, const Vec3& at_m, const Vec3& towards) {
  if (!box.holds(at_m)) return 0.0;
  double way_m = 0.0;
  while (box.holds(at_m + way_m * towards)) way_m += 5e-4;
  return way_m;
}

PlaceBox on_street(Draw& draw) {
  const double turn_rad = draw.below(2) == 0 ? 0.0 : draw.between(-0.4, 0.4);
  return {draw.inside(Vec3(-12, -0.6, 1.4), Vec3(12, 0.6, 1.6)),
          {std::cos(turn_rad), std::sin(turn_rad), 0},
          {draw.between(1.0, 3.5), draw.between(0.3, 0.8), draw.between(0.1, 0.4)}};
}

/// Devices that drive along one line over a ground, at different moments.
struct Column {
  Column(std::size_t count, double by_m)
      : step_m(by_m),
        traced(ground()),
        outlines(traced.scene),
        halves(kept_halves(count, 64)),
        at_m(count),
        entered(count) {
    for (KeptHalf& half : halves) half.keep_places({2.0, false, false, true, &known});
  }

  static Scene ground() {
    TriangleMesh mesh;
    add_sheet(mesh, Vec3(0.0), Vec3(200, 0, 0), Vec3(0, 200, 0), "opaque");
    add_box_faces(mesh, Vec3(-5, 20, 0), Vec3(5, 30, 8), "metal");
    return scene_of(mesh);
  }
  /// All of them drive on, then what they have come into is told.
  void go_on(double aside_m = 0.0) {
    for (std::size_t number = 0; number < halves.size(); ++number) {
      at_m[number] += step_m;
      const Vec3 at(at_m[number], number == 0 ? 0.0 : aside_m, 1.5);
      halves[number].update(traced.scene, outlines, traced.end(at), {});
    }
    entered.clear();
    for (KeptHalf& half : halves) {
      entered.push_back(half.take_entered());
      if (entered.back()) known.note(entered.back());
      CHECK(!half.take_entered());  // once
    }
    known.next_frame(1000);
  }

  double step_m;
  TracedScene<> traced;
  FacetOutlines outlines;
  KnownPlaces known;
  std::vector<KeptHalf> halves;
  std::vector<double> at_m;
  std::vector<std::shared_ptr<const Place>> entered;  ///< in the last frame
};

}  // namespace

TEST_CASE("a device comes out of a box where it does when it walks step by step") {
  Draw draw(5);
  for (int round = 0; round < 300; ++round) {
    const PlaceBox box = on_street(draw);
    const Vec3 at_m = box.middle_m + draw.inside(Vec3(-3, -1, -0.3), Vec3(3, 1, 0.3));
    const Vec3 towards = glm::normalize(draw.inside(Vec3(-1, -1, -0.2), Vec3(1, 1, 0.2)));
    CHECK(std::abs(box.way_out_m(at_m, towards) - walked_out_m(box, at_m, towards)) < 1e-3);
  }
}

TEST_CASE(
    "of the places that are known a device takes that which holds it longest, if it or the next one does so long") {
  Draw draw(6);
  std::size_t long_ones = 0, short_ones = 0, none = 0;
  for (int round = 0; round < 200; ++round) {
    KnownPlaces known;
    std::vector<PlaceBox> boxes;
    const std::size_t count = 1 + draw.below(12);
    for (std::size_t place = 0; place < count; ++place) {
      boxes.push_back(on_street(draw));
      known.note(place_at(boxes.back()));
      known.note(place_at(on_street(draw), true));  // not what is looked for
    }
    REQUIRE(known.size() == 2 * count);
    const Vec3 at_m = draw.inside(Vec3(-12, -0.5, 1.45), Vec3(12, 0.5, 1.55));
    const double step_m = draw.below(2) == 0 ? draw.between(0.05, 0.9) : draw.between(1.0, 2.0);
    const Vec3 towards(draw.below(2) == 0 ? 1.0 : -1.0, 0.0, 0.0);
    const auto farthest_m = [&](const Vec3& from_m) {
      double way_m = 0.0;
      for (const PlaceBox& box : boxes) way_m = std::max(way_m, walked_out_m(box, from_m, towards));
      return way_m;
    };
    const double own_m = farthest_m(at_m), enough_m = step_m < 1.0 ? 2.0 : 3.0;
    Vec3 out_m = at_m;
    for (double way_m = 0.0; way_m < own_m; way_m += step_m) out_m += step_m * towards;
    const double next_m = farthest_m(out_m);
    if (std::abs(own_m - enough_m) < 2e-3 || std::abs(next_m - enough_m) < 2e-3) continue;
    if (std::abs(own_m / step_m - std::round(own_m / step_m)) * step_m < 2e-3) continue;  // which step it is out after
    const std::shared_ptr<const Place> found = known.find(at_m, step_m * towards, false);
    const bool expects = own_m > 0.0 && (own_m > enough_m || next_m > enough_m);
    REQUIRE((found != nullptr) == expects);
    ++(!expects ? none : own_m > enough_m ? long_ones : short_ones);
    if (!found) continue;
    CHECK(found->beams() == nullptr);
    CHECK(std::abs(walked_out_m(found->box(), at_m, towards) - own_m) < 1e-3);
  }
  MESSAGE(long_ones << " long, " << short_ones << " short and continued, " << none << " none");
  CHECK(long_ones > 30);
  CHECK(short_ones > 10);
  CHECK(none > 30);
  KnownPlaces known;
  known.note(place_at({Vec3(0.0), Vec3(1, 0, 0), Vec3(3, 1, 1)}));
  CHECK(known.find(Vec3(0.1, 0, 0), Vec3(1, 0, 0), false) == nullptr);  // it must last for 3 m
  CHECK(known.find(Vec3(-0.1, 0, 0), Vec3(1, 0, 0), false) != nullptr);
  CHECK(known.find(Vec3(-0.1, 0, 0), Vec3(0.0), false) == nullptr);  // going nowhere
}

TEST_CASE("of too many places those are forgotten that nobody came into for longest, and all after a while") {
  KnownPlaces known;
  std::vector<std::shared_ptr<const Place>> places;
  for (int place = 0; place < 8; ++place) {
    places.push_back(place_at({Vec3(10.0 * place, 0, 0), Vec3(1, 0, 0), Vec3(2, 1, 1)}));
    known.note(places.back());
    CHECK(!known.next_frame(100));
  }
  CHECK(!known.are_shared());
  known.note(places[1]);
  CHECK(known.are_shared());
  CHECK(known.next_frame(3));
  for (std::size_t place = 0; place < places.size(); ++place) {
    CAPTURE(place);
    CHECK(known.holds(*places[place]) == (place == 1 || place > 5));
  }
  int frames = 0;
  while (known.size() > 0 && frames < 10'000) {
    known.next_frame(100);
    ++frames;
  }
  CHECK(frames > 300);
  CHECK(frames < 3000);
  CHECK(!known.next_frame(0));
  known.note(places[0]);
  CHECK(known.next_frame(0));
  CHECK(known.size() == 0);
}

TEST_CASE("who follows makes no places, whatever the distance") {
  for (const double step_m : {0.14, 0.5, 0.9, 1.4, 1.9}) {
    for (const double gap_m : {15.0, 15.7, 18.9, 23.3}) {
      CAPTURE(step_m);
      CAPTURE(gap_m);
      Column column(4, step_m);
      for (std::size_t number = 0; number < 4; ++number)
        column.at_m[number] = -90.0 - gap_m * static_cast<double>(number);
      std::set<const Place*> of_leader;
      std::size_t taken = 0, own = 0, without = 0;
      for (int frame = 0; frame < static_cast<int>(220.0 / step_m); ++frame) {
        column.go_on(0.1);
        if (const auto place = column.entered[0]) of_leader.insert(place.get());
        const bool settled = static_cast<double>(frame) * step_m > 130.0;  // all drive where the first one knew of them
        for (std::size_t number = 1; number < 4 && settled; ++number) {
          without += column.halves[number].place() ? 0U : 1U;
          const auto place = column.entered[number];
          taken += place ? 1U : 0U;
          own += place && !of_leader.contains(place.get()) ? 1U : 0U;
        }
      }
      CHECK(without == 0);
      CHECK(own == 0);
      CHECK(taken > 12);
    }
  }
}

TEST_CASE("nobody has come after a device that is alone, though it stops on its way") {
  Column column(1, 0.5);
  column.at_m = {-60.0};
  std::size_t places = 0;
  for (int frame = 0; frame < 120; ++frame) {
    column.step_m = frame % 30 < 20 ? 0.5 : 0.0;
    column.go_on();
    places += column.entered[0] ? 1U : 0U;
  }
  CHECK(places > 4);
  CHECK(column.known.size() == places);
  CHECK(!column.known.are_shared());
}

TEST_CASE("a device that is alone leaves gaps between its places, and none once somebody has followed") {
  Column column(2, 1.4);
  column.at_m = {-60.0, -75.0};
  std::vector<std::shared_ptr<const Place>> before, after;
  for (int frame = 0; frame < 90; ++frame) {
    const bool was_shared = column.known.are_shared();
    column.go_on();
    const auto place = column.entered[0];
    if (place && (after.empty() || after.back() != place)) (was_shared ? after : before).push_back(place);
  }
  REQUIRE(before.size() > 1);
  REQUIRE(after.size() > 5);
  const auto gap_m = [](const Place& one, const Place& next) {
    return (next.box().middle_m.x - next.box().half_m.x) - (one.box().middle_m.x + one.box().half_m.x);
  };
  for (std::size_t at = 2; at < after.size(); ++at) {  // the first of them may have been begun before
    CHECK(gap_m(*after[at - 1], *after[at]) < 0.0);
    CHECK(gap_m(*after[at - 1], *after[at]) > -0.3);
  }
}

TEST_CASE(
    "of work that some frames share as much is done as frames have gone by, to within a step, and all of it in time") {
  Draw draw(8);
  for (int round = 0; round < 400; ++round) {
    std::vector<int> work(1 + draw.below(15));
    for (int& one : work) one = 1 + static_cast<int>(draw.below(20));
    const WorkSteps steps(work);
    const int frames = 1 + static_cast<int>(draw.below(30)), all = steps.left(steps.count());
    const double early = draw.between(0.01, 0.99), largest = *std::ranges::max_element(work), hair = 1e-9;
    int steps_left = steps.count();
    WorkAllowance allowance;
    for (int frame = 1; frame <= frames; ++frame) {
      allowance.next_frame(steps.left(steps_left), frames + 1 - frame);
      while (steps_left > 0 && allowance.covers(steps.next(steps_left), early)) {
        allowance.spend(steps.next(steps_left--));
      }
      const double done = all - steps.left(steps_left), even = static_cast<double>(all) * frame / frames;
      CHECK(done <= even + early * largest + hair);
      CHECK(done >= even - (1.0 - early) * largest - hair);
    }
    CHECK(steps_left == 0);
  }
  WorkAllowance late, busy;
  late.next_frame(10, 0);
  CHECK(late.covers(10, 0.5));  // now
  busy.spend(5);                // with something else
  busy.next_frame(10, 5);
  CHECK_FALSE(busy.covers(1, 0.5));
}

TEST_CASE("what devices take early is far apart, of one beside the next and of a few") {
  for (std::size_t device = 0; device < 1'000; ++device) {
    CHECK(early_of(device) > 0.0);
    CHECK(early_of(device) < 1.0);
    for (std::size_t other = 1; other <= 10; ++other) {
      const double apart = std::abs(early_of(device + other) - early_of(device));
      CHECK(std::min(apart, 1.0 - apart) > 0.3 / static_cast<double>(other));
    }
  }
}

TEST_CASE(
    "who drives fast makes places where he leads others, takes over those of others, and makes none for himself") {
  const auto drive = [](bool leads, bool follows, double step_m) {
    Column column(2, step_m);
    column.at_m = {30.0, 0.0};
    PlaceUse use{0.75, false, false, true, &column.known, 2.0};
    std::set<const Place*> made, taken_over;
    for (int frame = 0; frame < 80; ++frame) {
      use.leads = leads;
      use.follows = false;
      column.halves[0].keep_places(use);
      use.leads = false;
      use.follows = follows;
      column.halves[1].keep_places(use);
      column.go_on();
      if (column.entered[0]) made.insert(column.entered[0].get());
      if (column.entered[1]) {
        CHECK(made.contains(column.entered[1].get()));
        taken_over.insert(column.entered[1].get());
      }
    }
    return std::pair(made.size(), taken_over.size());
  };
  const auto [made, taken_over] = drive(true, true, 1.4);
  CHECK(made > 5);
  CHECK(taken_over > 3);
  CHECK(taken_over < made);
  constexpr std::pair<std::size_t, std::size_t> none(0, 0);
  CHECK(drive(true, false, 1.4) == std::pair(made, std::size_t{0}));
  CHECK(drive(false, true, 1.4) == none);
  CHECK(drive(true, true, 2.1) == none);
}

}  // namespace test_known_places
