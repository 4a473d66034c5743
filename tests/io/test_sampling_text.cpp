/// What is sampled is said with what it lacks; where nothing is sampled nothing is said.
#include "dcem/io/sampling_text.hpp"

#include <doctest/doctest.h>

#include <string>

#include "dcem/io/heat_map.hpp"
#include "dcem/io/summary.hpp"
#include "dcem/sim/discovery.hpp"

namespace test_sampling_text {

using namespace dcem;

namespace {

SamplingReport report() {
  SamplingReport report;
  report.is_sampled = true;
  report.rays = 2000;
  report.reference_rays = 20'000;
  report.links = {{4, 5, 0.04}, {2, 3, 1.25}, {0, 2, 0.0}};
  return report;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a warning names what is sampled, how it was checked, and what is missing") {
  CHECK(io::sampling_warning(report(), "paths of more than 3 interactions") ==
        "sampled: paths of more than 3 interactions are looked for by 2000 rays, which found 60 % of the paths of 3 "
        "links "
        "searched again with 20000 rays; powers lack 0.04 dB in the median, 1.2 dB on the worst link; on 1 no path was "
        "found "
        "though "
        "there is one");
  SamplingReport exact = report();
  exact.exact = true;
  exact.rays_steady = 200;
  exact.links.assign(20, {2, 3, 1.25});
  const std::string said = io::sampling_warning(exact, "all");
  CHECK(contains(said, "2000 rays (200 and what is remembered from the second frame on), which found 67 %"));
  CHECK(contains(said, "20 links searched again exactly; powers lack 1.2 dB in the median, 1.2 dB at 95 %"));
}

TEST_CASE("what was not checked, what was not found at all and what is not there are said as what they are") {
  SamplingReport unchecked = report();
  unchecked.links.clear();
  CHECK(contains(io::sampling_warning(unchecked, "all"), "2000 rays; what they lack was not checked"));
  CHECK(io::sampling_notes(unchecked).size() == 1);
  SamplingReport blind = report();
  blind.links = {{0, 2, 0.0}};
  const std::string said = io::sampling_warning(blind, "all");
  CHECK(contains(said, "found 0 % of the paths of 1 link searched again"));
  CHECK(contains(said, "on 1 no path was found though there is one"));
  CHECK_FALSE(contains(said, "dB"));
  CHECK(contains(io::sampling_notes(blind)[1], "no path found on 1 of 1 link that have one"));
  SamplingReport empty = report();
  empty.links = {{0, 0, 0.0}};
  CHECK(contains(io::sampling_warning(empty, "all"),
                 "on 1 link searched again with 20000 rays no path was found either"));
}

TEST_CASE("what rays look for follows from the orders and the plan") {
  PropagationSettings propagation;
  propagation.max_reflections = 4;
  CHECK(io::sampled_kinds(propagation, {Discovery::sampled, false, 3}) == "paths of more than 3 interactions");
  CHECK(io::sampled_kinds(propagation, {Discovery::sampled}) == "all paths but the direct one");
  propagation.max_diffractions = 2;
  CHECK(contains(io::sampled_kinds(propagation, {Discovery::sampled, false, 3}), "two diffractions and a reflection"));
}

TEST_CASE("the summary and the table have the check, and neither has one where nothing is sampled") {
  const Scene scene;
  io::RunFacts facts;
  facts.sampled_kinds = "paths of more than 3 interactions";
  io::RunSummary summary(facts, scene);
  CHECK(contains(summary.json(), "\"sampling\": null"));
  CHECK(summary.late_warnings().empty());
  CHECK_FALSE(contains(summary.table("out"), "sampled:"));
  CHECK(io::sampling_notes({}).empty());
  summary.set_sampling(report());
  CHECK(contains(summary.json(), "\"recall\": 0.6"));
  REQUIRE(summary.late_warnings().size() == 1);
  CHECK(contains(summary.late_warnings().front(), "sampled: paths of more than 3 interactions"));
  CHECK(contains(summary.table("out"), "sampled: 2000 rays find 60 % of the paths"));
}

TEST_CASE("notes make the picture higher by a line each, and no wider") {
  io::HeatMap map;
  map.columns = map.rows = 20;
  map.values.assign(400, -80.0);
  const io::HeatMapLayout plain = io::heat_map_layout(map);
  map.notes = io::sampling_notes(report());
  const io::HeatMapLayout noted = io::heat_map_layout(map);
  CHECK(noted.height_px > plain.height_px);
  CHECK(noted.width_px == plain.width_px);
  CHECK(noted.plot.y == plain.plot.y);
}

}  // namespace test_sampling_text
