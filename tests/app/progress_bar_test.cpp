#include "app/progress_bar.hpp"

#include <gtest/gtest.h>

namespace stillkite {
namespace {

TEST(ProgressBar, ShowsShareRateAndTimeLeft) {
  EXPECT_EQ(progress_line("simulate", 30, 120, 15),
            "simulate [#######.......................]  25 %  30/120  2.0/s  0:45 left");
}

TEST(ProgressBar, ShowsCountAndRateWithoutTotal) {
  EXPECT_EQ(progress_line("run", 50, std::nullopt, 4), "run 50  12.5/s");
}

TEST(ProgressBar, HandlesZeroTimeAndExcessSteps) {
  EXPECT_EQ(progress_line("run", 0, 10, 0),
            "run [..............................]   0 %  0/10  0.0/s  ? left");
  EXPECT_EQ(progress_line("run", 12, 10, 1),
            "run [##############################] 100 %  12/10  12.0/s  0:00 left");
}

}  // namespace
}  // namespace stillkite
