#include <doctest/doctest.h>

#include <vector>

#include "dcem/core/statistics.hpp"

namespace test_statistics {

using namespace dcem;

TEST_CASE("nearest rank: the textbook's five and ten values") {
  const std::vector<double> five{50, 15, 40, 20, 35};  // 15 20 35 40 50
  CHECK(quantile(five, 0.05) == 15);
  CHECK(quantile(five, 0.30) == 20);
  CHECK(quantile(five, 0.40) == 20);
  CHECK(quantile(five, 0.50) == 35);
  CHECK(quantile(five, 1.00) == 50);
  const std::vector<double> ten{3, 6, 7, 8, 8, 10, 13, 15, 16, 20};
  CHECK(quantile(ten, 0.25) == 7);
  CHECK(quantile(ten, 0.50) == 8);
  CHECK(quantile(ten, 0.75) == 15);
}

TEST_CASE("the rank of a common share is exact for every size of the sample") {
  std::vector<double> sample;
  for (int size = 1; size <= 400; ++size) {
    sample.insert(sample.begin(), size);  // values 1 … size, falling
    CHECK(quantile(sample, 0.95) == (95 * size + 99) / 100);
    CHECK(quantile(sample, 0.99) == (99 * size + 99) / 100);
    CHECK(quantile(sample, 0.50) == (size + 1) / 2);
    CHECK(median(sample) == (size + 1) / 2);
    CHECK(quantile(sample, 0.0) == 1);
    CHECK(quantile(sample, 1.0) == size);
  }
}

TEST_CASE("a quantile is a member of the sample, and shares outside 0…1 give its ends") {
  CHECK(quantile({4.0}, 0.5) == 4.0);
  CHECK(quantile({4.0, 2.0}, -1.0) == 2.0);
  CHECK(quantile({4.0, 2.0}, 7.0) == 4.0);
}

TEST_CASE("an empty sample has 0 for everything") {
  CHECK(quantile({}, 0.5) == 0.0);
  CHECK(median({}) == 0.0);
  CHECK(mean({}) == 0.0);
}

TEST_CASE("the mean is the sum over the count") {
  CHECK(mean({1.0, 2.0, 6.0}) == 3.0);
  CHECK(mean({-5.0}) == -5.0);
}

}  // namespace test_statistics
