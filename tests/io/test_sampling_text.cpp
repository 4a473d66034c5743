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
        "links that were searched again with 20000; their powers lack 0.04 dB in the median, 1.2 dB at 95 %; on 1 of "
        "them no path was found though there is one");
  SamplingReport exact = report();
  exact.exact = true;
  CHECK(contains(io::sampling_warning(exact, "all"), "searched again exactly"));
  SamplingReport too_long;
  too_long.rays = 2000;
  too_long.is_too_long = true;
  CHECK(io::sampling_warning(too_long, "all paths") ==
        "sampled: all paths are looked for by 2000 rays; what they lack is not known: a second search would take too "
        "long");
  CHECK(io::sampling_notes(too_long).size() == 2);
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
