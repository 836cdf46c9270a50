#include "geometry/time.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

TEST(Timestamp, DifferenceKeepsNanoseconds) {
  // 1.4e18 ns exceed the 53 bits of a double: the difference must be integer
  const Timestamp from{1'403'636'579'763'555'584};
  const Timestamp to{from.ns + 1};
  EXPECT_DOUBLE_EQ(seconds_between(from, to), 1e-9);
  EXPECT_DOUBLE_EQ(seconds_between(to, from), -1e-9);
  EXPECT_LT(from, to);
}

TEST(Timestamp, FromSecondsRoundsToNearestNanosecond) {
  EXPECT_EQ(from_seconds(0.1).ns, 100'000'000);
  EXPECT_EQ(from_seconds(-0.1).ns, -100'000'000);
  EXPECT_EQ(from_seconds(1.0 / 3.0).ns, 333'333'333);
  EXPECT_EQ(from_seconds(-2.0 / 3.0).ns, -666'666'667);
  EXPECT_DOUBLE_EQ(to_seconds(from_seconds(12.25)), 12.25);
}

}  // namespace
}  // namespace stillkite
