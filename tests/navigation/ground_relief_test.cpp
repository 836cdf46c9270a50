#include <gtest/gtest.h>

#include <cmath>

#include "tests/navigation/rendered_flight.hpp"

// The flow over ground with relief, and with a lens that is known to some pixels.

namespace stillkite {
namespace {

int measured_frames(const std::vector<NavigationEstimate>& estimates) {
  int count = 0;
  for (const NavigationEstimate& e : estimates) count += e.verdict == Verdict::ok ? 1 : 0;
  return count;
}

double velocity_rms_m_s(const test::RenderedFlight& flight, double lens_sigma_px) {
  const auto estimates =
      test::fly(flight.navigator({.lens_sigma_px = lens_sigma_px}), flight.frames);
  double sum = 0;
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    sum += (estimates[i].twist_in_camera.velocity_m_s -
            flight.record.twists_in_camera[i - 1].twist.velocity_m_s)
               .squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(estimates.size() - 1));
}

TEST(GroundRelief, HillsOfAQuarterOfTheHeightAreNotFlat) {
  SimulationConfig config = test::small_flight(1);
  config.ground.relief = {.amplitude_m = 10, .correlation_length_m = 6};
  const test::RenderedFlight flight = test::render_flight(config);
  const auto estimates = test::fly(flight.navigator(), flight.frames);
  EXPECT_LT(measured_frames(estimates), 5);
  EXPECT_EQ(estimates.back().verdict, Verdict::not_flat);
}

TEST(GroundRelief, FlatGroundIsFlat) {
  const test::RenderedFlight& flight = test::rendered_flight();
  EXPECT_EQ(measured_frames(test::fly(flight.navigator(), flight.frames)),
            static_cast<int>(flight.frames.size()) - 1);
}

// Common errors are no noise of the filter: the velocity does not depend on their size.
TEST(GroundRelief, LensSigmaDoesNotCostVelocity) {
  const test::RenderedFlight& flight = test::rendered_flight();
  EXPECT_LT(velocity_rms_m_s(flight, 2), 1.1 * velocity_rms_m_s(flight, 0));
}

}  // namespace
}  // namespace stillkite
