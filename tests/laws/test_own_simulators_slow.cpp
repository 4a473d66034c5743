/// Simulators that dcem::engine does not hold: over another tree, and with a surface model of the caller's own. Each
/// takes as long to compile as the simulator itself.
#include <doctest/doctest.h>

#include <complex>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dcem/accel/binary_index.hpp"
#include "tests/laws/moving_room.hpp"

namespace test_own_simulators_slow {

using namespace dcem;
using namespace dcem::test;
using namespace moving_room;

namespace {

/// Halves every amplitude and lets through a tenth, whatever the material.
struct HalfMirror {
  SurfaceResponse response(MaterialId, double) const { return {{-0.5, 0.5}, {0.1, 0.1}}; }
};

std::vector<std::string> kinds_of(const LinkResult& link) {
  std::vector<std::string> all;
  for (const PathContribution& path : link.paths) all.push_back(kinds(path));
  return all;
}

}  // namespace

TEST_CASE("determinism: over the binary tree every bit is that of the wide one") {
  for (const Way& way : all_ways) {
    CHECK(run<BinaryIndex>(ordered_scene(), way, 1, all_frames) == run<WideIndex>(ordered_scene(), way, 1, all_frames));
  }
}

TEST_CASE("a surface model of the caller's own sets every amplitude") {
  using Strings = std::vector<std::string>;
  Scene scene = scene_through_files({sheet(Vec3(0), Vec3(9, 0, 0), Vec3(0, 9, 0), "glass")});
  scene.add_transmitter(device_at("t", Vec3(-2, 0.5, 1.5), 0.0, antenna(PolarizationKind::dual)));
  scene.add_receiver(device_at("above", Vec3(2, 0.5, 1.5), 0.0, antenna(PolarizationKind::dual)));
  scene.add_receiver(device_at("below", Vec3(2, 0.5, -1.5), 0.0, antenna(PolarizationKind::dual)));
  BasicSimulator<HalfMirror> simulator(std::move(scene), law_settings(1, 1), HalfMirror{});
  const FrameResult result = simulator.advance_to(0.0);
  REQUIRE(kinds_of(result.links.at(0)) == Strings{"", "R"});
  REQUIRE(kinds_of(result.links.at(1)) == Strings{"T"});
  const double wavelength_m = speed_of_light_mps / law_frequency_hz, five_m = wavelength_m / (4.0 * pi * 5.0);
  // In the plane of incidence θ̂ and φ̂ are TM and TE: |entries| are a half and a tenth of free space over 5 m.
  for (const auto& [link, path, factor] : {std::tuple(0U, 1U, 0.5), {1U, 0U, 0.1}}) {
    const ComplexMatrix2& transfer = result.links[link].paths[path].transfer;
    CHECK(std::abs(transfer(0, 0)) == doctest::Approx(factor * five_m).epsilon(1e-12).scale(0.0));
    CHECK(std::abs(transfer(1, 1)) == doctest::Approx(factor * five_m).epsilon(1e-12).scale(0.0));
    CHECK(std::abs(transfer(0, 1)) < 1e-12 * five_m);
  }
}

}  // namespace test_own_simulators_slow
