#include "live/mavlink/verdict_monitor.hpp"

#include <gtest/gtest.h>

namespace stillkite::mavlink {
namespace {

Timestamp at(double t_s) {
  return from_seconds(t_s);
}

TEST(VerdictMonitor, WarnsOnceAfterASecondAndReportsTheEnd) {
  VerdictMonitor monitor;
  int warnings = 0, notices = 0;
  for (int k = 0; k < 400; ++k) {
    const double t_s = 0.01 * k;
    const bool is_lost = t_s > 1 && t_s < 2.5;
    const auto text = monitor.update(at(t_s), is_lost ? Verdict::lost : Verdict::ok);
    if (!text) continue;
    if (text->severity == 4) {
      ++warnings;
      EXPECT_NEAR(t_s, 2.0, 0.03);
      EXPECT_EQ(std::string(text->text.data()), "vision: lost for 1 s");
    } else {
      ++notices;
      EXPECT_NEAR(t_s, 3.5, 0.03);
    }
  }
  EXPECT_EQ(warnings, 1);
  EXPECT_EQ(notices, 1);
}

TEST(VerdictMonitor, KeepsSilentOnShortInterruptions) {
  VerdictMonitor monitor;
  for (int k = 0; k < 400; ++k) {
    EXPECT_FALSE(monitor.update(at(0.01 * k), k % 60 < 40 ? Verdict::frozen : Verdict::ok));
  }
}

TEST(VerdictMonitor, WarnsOnceWithoutImages) {
  VerdictMonitor monitor;
  EXPECT_FALSE(monitor.update(at(0), Verdict::ok));
  EXPECT_FALSE(monitor.without_image(0.9));
  EXPECT_TRUE(monitor.without_image(1.1));
  EXPECT_FALSE(monitor.without_image(5));
  EXPECT_FALSE(monitor.update(at(6), Verdict::ok));
  EXPECT_TRUE(monitor.update(at(7.1), Verdict::ok));
}

NavigationEstimate estimate_at(double t_s, Verdict verdict) {
  NavigationEstimate estimate;
  estimate.stamp = at(t_s);
  estimate.verdict = verdict;
  estimate.scale = ScaleSource::initial_height;
  return estimate;
}

TEST(ResetCounter, CountsGapsAndRelocalizations) {
  ResetCounter counter(0.5);
  EXPECT_EQ(counter.update(estimate_at(0, Verdict::first_frame)), 0);
  EXPECT_EQ(counter.update(estimate_at(0.1, Verdict::ok)), 0);
  EXPECT_EQ(counter.update(estimate_at(0.2, Verdict::lost)), 0);
  EXPECT_EQ(counter.update(estimate_at(0.4, Verdict::ok)), 0);
  EXPECT_EQ(counter.update(estimate_at(1.0, Verdict::ok)), 1);
  NavigationEstimate relocalized = estimate_at(1.1, Verdict::ok);
  relocalized.reference.emplace();
  relocalized.reference->relocalized = true;
  EXPECT_EQ(counter.update(relocalized), 2);
  EXPECT_EQ(counter.update(estimate_at(1.2, Verdict::ok)), 2);
}

TEST(ResetCounter, CountsALostScaleButNoneBeforeTheFirst) {
  ResetCounter counter(0.5);
  const auto update = [&](double t_s, ScaleSource scale) {
    NavigationEstimate estimate = estimate_at(t_s, Verdict::ok);
    estimate.scale = scale;
    return counter.update(estimate);
  };
  EXPECT_EQ(update(0.0, ScaleSource::none), 0);
  EXPECT_EQ(update(0.1, ScaleSource::initial_height), 0);
  EXPECT_EQ(update(0.2, ScaleSource::range), 0);
  EXPECT_EQ(update(0.3, ScaleSource::none), 0);
  EXPECT_EQ(update(0.4, ScaleSource::range), 1);
  EXPECT_EQ(update(0.5, ScaleSource::range), 1);
}

}  // namespace
}  // namespace stillkite::mavlink
