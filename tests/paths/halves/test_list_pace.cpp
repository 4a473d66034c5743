/// What an end that stands lists is listed where that pays, and costs little where nobody knows.
#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <optional>

#include "dcem/paths/halves/kept_half.hpp"
#include "tests/paths/halves/small_town.hpp"

namespace test_list_pace {

using namespace dcem;
using namespace dcem::test;

namespace {

/// Rows of houses around a mast.
Scene rows_of_houses() {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0.0), Vec3(150, 0, 0), Vec3(0, 150, 0), "opaque");
  for (int row = -6; row < 6; ++row) {
    for (int column = -6; column < 6; ++column) {
      const Vec3 low_m(20.0 * row + 5.0, 20.0 * column + 5.0, 0.0);
      add_box_faces(mesh, low_m, low_m + Vec3(10, 10, 6 + (7 * row + 3 * column + 100) % 5), "metal");
    }
  }
  return scene_of(mesh);
}

/// A mast that is joined with so many receivers in each frame.
class Mast {
 public:
  explicit Mast(bool over_edges = false) : over_edges_(over_edges) {}

  /// After how many frames it has listed what it reaches over its mirrors, or edges; none: not within so many.
  std::optional<std::size_t> frames_until_listed(std::size_t receivers, std::size_t most, const ListPace& pace) {
    for (std::size_t frame = 0; frame < most; ++frame) {
      HalfLists wanted{&lanes_, true, over_edges_, receivers};
      wanted.pace = pace;
      if (pace.frames_left) wanted.pace.frames_left = *pace.frames_left - frame;
      half_.update(traced_.scene, outlines_, end_, {}, wanted);
      if (half_.lists() != nullptr && (!over_edges_ || half_.lists()->knows_edges())) return frame + 1;
    }
    return std::nullopt;
  }
  /// From now on it takes places into account, as where frames follow each other.
  Mast& keeping_places() {
    half_.keep_places({});
    return *this;
  }

 private:
  TracedScene<> traced_{rows_of_houses()};
  FacetOutlines outlines_{traced_.scene};
  LaneScene lanes_{traced_.scene, outlines_};
  LinkEnd end_ = traced_.end(Vec3(0, 0, 25));
  KeptHalf half_{64};
  bool over_edges_;
};

/// Where it is known how many frames there will be.
std::optional<std::size_t> frames_until_listed(std::size_t receivers, std::size_t frames) {
  return Mast().keeping_places().frames_until_listed(receivers, frames, {frames, 0.0});
}

}  // namespace

TEST_CASE("a mast lists nothing where the frames there will be are too few to pay, and in the first ones of many") {
  const std::optional<std::size_t> soon = frames_until_listed(1, 1000);
  REQUIRE(soon);
  CHECK(frames_until_listed(1, *soon + 5) == std::nullopt);
  CHECK(frames_until_listed(1, 10'000) == soon);
  constexpr std::size_t without_end = std::numeric_limits<std::size_t>::max();
  CHECK(Mast().keeping_places().frames_until_listed(1, 1000, {without_end, 0.0}) == soon);
  // Ten receivers pay as much in a tenth of the frames.
  CHECK(frames_until_listed(10, 1000) < soon);
  CHECK(frames_until_listed(10, 100).has_value());
  CHECK(frames_until_listed(1, 100) == std::nullopt);
}

TEST_CASE("where nobody knows how many frames there will be, a mast lists when that would have paid, as from scratch") {
  constexpr std::size_t most = 1000;
  for (const std::size_t receivers : {1U, 3U}) {
    const std::optional<std::size_t> soon = frames_until_listed(receivers, most),
                                     at_once = Mast().frames_until_listed(receivers, most, {}),
                                     spread = Mast().keeping_places().frames_until_listed(receivers, most, {});
    REQUIRE((soon && at_once && spread));
    CHECK(*at_once > *soon);
    CHECK(*spread > *at_once);  // not all in one frame
    CHECK(*spread <= *at_once + *soon);
  }
}

TEST_CASE("lists over edges take what frames are spared, unless they are known to pay") {
  constexpr std::size_t most = 20'000;
  const auto until_listed = [](const ListPace& pace) { return Mast(true).frames_until_listed(1, most, pace); };
  const std::optional<std::size_t> known = until_listed({most, 0.0}), spared = until_listed({std::nullopt, 0.5}),
                                   not_spared = until_listed({});
  REQUIRE((known && spared && not_spared));
  CHECK(*known < *spared);
  CHECK(*spared < *not_spared);
}

}  // namespace test_list_pace
