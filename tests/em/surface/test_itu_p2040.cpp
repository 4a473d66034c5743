#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/em/surface/itu_p2040.hpp"
#include "tests/support/shared_data.hpp"

namespace test_itu_p2040 {

using namespace dcem;

namespace {

/// The message of the std::invalid_argument that a call throws; empty if it throws none.
template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("P.2040 rows computed by hand") {
  // Concrete at 30 GHz: σ = 0.0462 · e^{0.7822 · ln 30} = 0.0462 · e^{2.6604165} = 0.0462 · 14.302245 = 0.6607637.
  const auto concrete = itu_properties("concrete", 30e9, 3, false);
  CHECK(concrete.relative_permittivity == 5.24);  // b = 0: the number itself
  CHECK(concrete.conductivity_s_per_m == doctest::Approx(0.6607637).epsilon(1e-6));
  CHECK_FALSE(concrete.extrapolated);
  // At 1 GHz and 10 GHz powers of ten: the coefficients can be read off.
  const auto wet = itu_properties("wet_ground", 1e9, 3, false);
  CHECK(wet.relative_permittivity == 30.0);
  CHECK(wet.conductivity_s_per_m == 0.15);
  // 30 · 10^−0.4 = 30 · 0.39810717 = 11.943215; 0.15 · 10^1.3 = 0.15 · 19.952623 = 2.9928935.
  const auto wet_10 = itu_properties("wet_ground", 10e9, 3, false);
  CHECK(wet_10.relative_permittivity == doctest::Approx(11.943215).epsilon(1e-7));
  CHECK(wet_10.conductivity_s_per_m == doctest::Approx(2.9928935).epsilon(1e-7));
  CHECK(itu_properties("metal", 30e9, 3, false).conductivity_s_per_m == 1e7);
  // The revisions differ: glass at 1 GHz.
  CHECK(itu_properties("glass", 1e9, 3, false).relative_permittivity == 6.31);
  CHECK(itu_properties("glass", 1e9, 4, false).relative_permittivity == 6.27);
  CHECK(itu_properties("glass", 1e9).relative_permittivity == 6.31);  // revision 3 unless told otherwise
}

TEST_CASE("frequency intervals are closed, and a material may have several") {
  CHECK_FALSE(itu_properties("concrete", 1e9, 3, false).extrapolated);
  CHECK_FALSE(itu_properties("concrete", 100e9, 3, false).extrapolated);
  CHECK_FALSE(itu_properties("wood", 1e6, 3, false).extrapolated);
  CHECK(itu_properties("glass", 220e9, 3, false).relative_permittivity == 5.79);
  CHECK(itu_properties("glass", 450e9, 3, false).relative_permittivity == 5.79);
  // Two intervals of revision 4 share their end: the lower one holds it.
  CHECK(itu_properties("wood", 100e9, 4, false).relative_permittivity == 1.99);
  CHECK(itu_properties("wood", 100.001e9, 4, false).relative_permittivity == 1.63);
}

TEST_CASE("outside the table: an error that names material, frequency and intervals, or the nearest interval") {
  const std::string message = refusal([] { itu_properties("glass", 150e9, 3, false); });
  CHECK(contains(message, "glass"));
  CHECK(contains(message, "150 GHz"));
  CHECK(contains(message, "0.1 to 100 and 220 to 450 GHz"));
  CHECK_FALSE(refusal([] { itu_properties("brick", 40.001e9, 3, false); }).empty());
  CHECK_FALSE(refusal([] { itu_properties("brick", 0.999e9, 3, false); }).empty());

  // The formula goes on: brick at 60 GHz, σ = 0.0238 · 60^0.16 = 0.0238 · 1.9253257 = 0.045822751.
  const auto brick = itu_properties("brick", 60e9, 3, true);
  CHECK(brick.extrapolated);
  CHECK(brick.relative_permittivity == 3.91);
  CHECK(brick.conductivity_s_per_m == doctest::Approx(0.045822751).epsilon(1e-8).scale(0.0));
  // Nearest by ratio: 100 → 140 is a factor 1.40, 140 → 220 one of 1.57; at 150 GHz 1.50 against 1.47.
  CHECK(itu_properties("glass", 140e9, 3, true).relative_permittivity == 6.31);
  CHECK(itu_properties("glass", 150e9, 3, true).relative_permittivity == 5.79);
  CHECK(itu_properties("glass", 150e9, 3, true).extrapolated);
  CHECK_FALSE(itu_properties("glass", 30e9, 3, true).extrapolated);
}

TEST_CASE("unknown materials, revisions and frequencies are refused") {
  CHECK(contains(refusal([] { itu_properties("cheese", 30e9, 3, true); }), "cheese"));
  const std::string elsewhere = refusal([] { itu_properties("wet_ground", 5e9, 4, true); });
  CHECK(contains(elsewhere, "revision 4"));
  CHECK(contains(elsewhere, "it is in revision 3"));
  CHECK(contains(refusal([] { itu_properties("concrete", 30e9, 2, true); }), "expected 3 or 4"));
  for (const double frequency_hz : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    CHECK_FALSE(refusal([=] { itu_properties("concrete", frequency_hz, 3, true); }).empty());
}

TEST_CASE("material names of a scene are recognised with either separator") {
  CHECK(itu_name_from_material_name("itu_concrete") == "concrete");
  CHECK(itu_name_from_material_name("itu-concrete") == "concrete");
  CHECK(itu_name_from_material_name("itu_medium_dry_ground") == "medium_dry_ground");
  CHECK(itu_name_from_material_name("itu-medium-dry-ground") == "medium_dry_ground");
  CHECK(itu_name_from_material_name("itu_vinyl_tile") == "vinyl_tile");  // only in revision 4
  CHECK_FALSE(itu_name_from_material_name("concrete"));
  CHECK_FALSE(itu_name_from_material_name("itu_cheese"));
  CHECK_FALSE(itu_name_from_material_name("itu_"));
  CHECK_FALSE(itu_name_from_material_name(""));
  CHECK(canonical_itu_name("ceiling-board") == "ceiling_board");
}

TEST_CASE("the list of names is sorted, without repetition, and every name can be looked up") {
  CHECK(itu_material_names(3).size() == 14);
  CHECK(itu_material_names(4).size() == 15);
  CHECK(itu_material_names(2).empty());
  for (const int revision : {3, 4}) {
    const auto names = itu_material_names(revision);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (i > 0) CHECK(names[i - 1] < names[i]);
      CHECK(canonical_itu_name(names[i]) == names[i]);
      CHECK(itu_properties(names[i], 30e9, revision, true).relative_permittivity >= 1.0);
    }
  }
}

TEST_CASE("every row of the reference table, and no other") {
  DCEM_NEEDS_SHARED();
  std::ifstream file(test::shared_path("itu/p2040.csv"));
  std::size_t row_index = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line.starts_with("rev")) continue;
    std::vector<std::string> cell;
    std::istringstream cells(line);
    for (std::string text; std::getline(cells, text, ',');) cell.push_back(text);
    REQUIRE(cell.size() == 8);
    REQUIRE(row_index < itu_rows.size());
    const ItuRow& row = itu_rows[row_index++];
    CAPTURE(line);
    CHECK(row.revision == std::stoi(cell[0]));
    CHECK(row.name == cell[1]);
    const double numbers[] = {row.min_frequency_ghz, row.max_frequency_ghz, row.a, row.b, row.c, row.d};
    for (std::size_t i = 0; i < 6; ++i) CHECK(numbers[i] == std::stod(cell[i + 2]));
  }
  CHECK(row_index == itu_rows.size());
}

}  // namespace test_itu_p2040
