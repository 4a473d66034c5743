/// What was found for one link in a place is taken over by the links of others that come into it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "dcem/paths/halves/kept_half.hpp"
#include "dcem/paths/memory/pooled_link.hpp"
#include "tests/paths/halves/small_street.hpp"

namespace test_known_pools {

using namespace dcem;
using namespace dcem::test;

namespace {

/// A street, two masts with their lists, and some places in it.
struct Street {
  explicit Street(Draw& draw)
      : traced(small_street(draw)), outlines(traced.scene), lanes(traced.scene, outlines), masts(kept_halves(2, 64)) {
    for (KeptHalf& mast : masts) {
      const LinkEnd end = traced.end(draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 9)));
      mast.update(traced.scene, outlines, end, settings, {&lanes, true, true, 1});
    }
    for (int place = 0; place < 3; ++place) {
      const PlaceBox box{draw.inside(Vec3(-8, -2, 0.5), Vec3(8, 2, 2)), {1, 0, 0}, {2, 0.5, 0.1}};
      places.push_back(std::make_shared<const Place>(traced.scene, outlines, box, settings));
    }
  }
  PoolSource source(const KnownPools& known, std::size_t mast) const {
    return {traced.scene, outlines, lanes, *masts[mast].lists(), {2, 1, 2}, known, mast};
  }

  TracedScene<> traced;
  FacetOutlines outlines;
  LaneScene lanes;
  HalfSettings settings;
  std::vector<KeptHalf> masts;
  std::vector<std::shared_ptr<const Place>> places;
};

}  // namespace

TEST_CASE("candidates of a place are found once for each transmitter, whoever comes into it") {
  Draw draw(4);
  const Street street(draw);
  KnownPools known;
  for (std::size_t place = 0; place < street.places.size(); ++place) {
    for (std::size_t mast = 0; mast < 2; ++mast) {
      PooledLink first, second, third;
      first.enter(street.source(known, mast), street.places[place]);
      CHECK(first.is_of(*street.places[place]));
      second.prepare(street.source(known, mast), street.places[place],
                     {.frames = 3});  // found for itself, at the same time
      const std::optional<PlacePools> news = first.news();
      REQUIRE(news);
      CHECK(!first.news());  // once
      CHECK(news->triples == nullptr);
      known.note(mast, *news);
      const PlacePools* const found = known.find(*street.places[place], mast);
      REQUIRE(found != nullptr);
      CHECK(found->pool == news->pool);
      CHECK(known.size() == 2 * place + mast + 1);
      third.enter(street.source(known, mast), street.places[place]);
      CHECK(third.is_of(*street.places[place]));
      CHECK(!third.news());
      second.enter(street.source(known, mast), street.places[place]);  // what it has begun is known by now
      CHECK(second.is_of(*street.places[place]));
      CHECK(!second.news());
      known.note(mast, *news);  // again: in the place of what was there
      CHECK(known.size() == 2 * place + mast + 1);
    }
  }
  for (const auto& place : street.places) {
    for (std::size_t mast = 0; mast < 2; ++mast) {
      REQUIRE(known.find(*place, mast) != nullptr);
      CHECK(&known.find(*place, mast)->pool->place() == place.get());
    }
    CHECK(known.find(*place, 2) == nullptr);
  }
  const Place* const kept = street.places[1].get();
  known.keep([&](const Place& place, std::size_t mast) { return &place == kept && mast == 1; });
  CHECK(known.size() == 1);
  CHECK(known.find(*kept, 0) == nullptr);
  CHECK(known.find(*kept, 1) != nullptr);
  known.clear();
  CHECK(known.size() == 0);
}

TEST_CASE("candidates from before the transmitter knew its edges are taken over by who is in a hurry alone") {
  Draw draw(9);
  Street street(draw);
  KeptHalf mast(64);
  const LinkEnd end = street.traced.end(draw.inside(Vec3(-8, -3, 2), Vec3(8, 3, 9)));
  const HalfLists wanted{&street.lanes, true, true, 0};
  mast.update(street.traced.scene, street.outlines, end, street.settings, wanted);
  REQUIRE(!mast.lists()->knows_edges());
  KnownPools known;
  const PoolSource source{street.traced.scene, street.outlines, street.lanes, *mast.lists(), {2, 1, 2}, known, 0};
  PooledLink early, late, hurried;
  early.enter(source, street.places[0]);
  known.note(0, *early.news());
  REQUIRE(known.find(*street.places[0], 0) != nullptr);
  HalfLists joined = wanted;
  joined.receivers = 100'000;
  mast.update(street.traced.scene, street.outlines, end, street.settings, joined);
  REQUIRE(mast.lists()->knows_edges());
  REQUIRE(known.find(*street.places[0], 0) != nullptr);
  CHECK(known.find(*street.places[0], 0)->pool->is_outdated());
  hurried.enter(source, street.places[0]);  // takes them nevertheless: they miss nothing
  CHECK(!hurried.news());
  late.prepare(source, street.places[0], {.frames = 3});
  late.enter(source, street.places[0]);
  const auto news = late.news();
  REQUIRE(news);
  CHECK(!news->pool->is_outdated());
  known.note(0, *news);
  CHECK(known.size() == 1);
  for (int frame = 0; frame < 20; ++frame) early.renew(source, street.places[0]);
  CHECK(!early.news());  // it went over to those of the late one
}

TEST_CASE("candidates of a place are of the scenery alone: what stands on bodies is another in the next frame") {
  Draw draw(11);
  std::size_t aimed = 0, on_bodies = 0, listed_on_bodies = 0;
  for (int round = 0; round < 12; ++round) {
    const Street street(draw);
    const Scene& scene = street.traced.scene;
    const auto body_of = [&](SequenceElement element) {
      return element.is_edge() ? scene.wedge(element.edge()).body : scene.facet(element.mirror()).body;
    };
    const BeamLists& reached = *street.masts[0].lists();
    for (const BeamMirror& mirror : reached.mirrors()) {
      listed_on_bodies += scene.facet(mirror.facet).body != BodyId(0) ? 1U : 0U;
    }
    for (const auto& place : street.places) {
      CandidatePool pool(place, reached, {2, 1, 3});
      while (pool.steps_left() > 0) pool.go_on(scene, street.outlines);
      const JoinGates gates(scene, street.outlines);
      CandidateWay way;
      for (std::size_t number = 0; number < pool.size(); ++number) {
        if (!pool.aim(gates, place->box().middle_m, number, way)) continue;
        ++aimed;
        on_bodies += std::ranges::any_of(way.elements, [&](SequenceElement at) { return body_of(at) != BodyId(0); });
      }
    }
  }
  MESSAGE(aimed << " candidates aimed at, " << listed_on_bodies << " mirrors on bodies");
  CHECK(on_bodies == 0);
  CHECK(aimed > 1'000);
  CHECK(listed_on_bodies > 20);
}

}  // namespace test_known_pools
