#include <gtest/gtest.h>

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/navigation/rendered_flight.hpp"

namespace stillkite {
namespace {

using test::is_finite;
using test::rendered_flight;

constexpr std::size_t kFirstBad = 15;
constexpr std::size_t kFirstGood = 24;

// NEES of the position, 3 degrees of freedom.
double position_nees(const NavigationEstimate& e, const RigidTransform& truth) {
  const Eigen::Vector3d error = e.world_from_body.translation - truth.translation;
  const Eigen::Matrix3d P = e.pose_covariance.topLeftCorner<3, 3>();
  return error.dot(P.ldlt().solve(error));
}

struct Fault {
  const char* name;
  std::function<cv::Mat(const cv::Mat&)> apply;
  bool pairs_may_align = false;  // consecutive faulty images align
  bool may_align = false;        // faulty images align to a keyframe among them
};

void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

const Fault kFaults[] = {
    {"black", [](const cv::Mat& p) { return cv::Mat(p.size(), CV_8UC1, cv::Scalar(0)); }},
    {"white", [](const cv::Mat& p) { return cv::Mat(p.size(), CV_8UC1, cv::Scalar(255)); }},
    {"sky",
     [](const cv::Mat& p) {
       cv::Mat grey(p.size(), CV_8UC1);
       cv::randn(grey, 200, 2);
       return grey;
     }},
    {"blurred",
     [](const cv::Mat& p) {
       cv::Mat grey;
       cv::GaussianBlur(p, grey, {}, 40);
       return grey;
     },
     true},
    {"over_exposed",
     [](const cv::Mat& p) {
       cv::Mat grey;
       p.convertTo(grey, CV_8U, 20, 100);
       return grey;
     }},
    {"noise",
     [](const cv::Mat& p) {
       cv::Mat grey(p.size(), CV_8UC1);
       cv::randn(grey, 128, 40);
       return grey;
     }},
    {"another_place",
     [](const cv::Mat& p) {
       cv::Mat grey;
       cv::flip(p, grey, -1);
       return grey;
     },
     true, true},
};

class BadFrames : public testing::TestWithParam<std::tuple<Mode, Fault>> {};

TEST_P(BadFrames, AreRejectedWithGrowingCovarianceAndRecover) {
  const auto& [mode, fault] = GetParam();
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator({}, mode);
  double variance = 0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    Frame frame = flight.frames[i];
    const bool bad = i >= kFirstBad && i < kFirstGood;
    if (bad) frame.grey = fault.apply(frame.grey);
    const NavigationEstimate e = navigator.step(frame);
    ASSERT_TRUE(is_finite(e)) << i;
    const double now = e.pose_covariance.topLeftCorner<3, 3>().trace();
    if (e.verdict != Verdict::ok) {
      EXPECT_GT(now, variance) << i;
    }
    if (bad && !fault.may_align && !(fault.pairs_may_align && mode == Mode::paper)) {
      EXPECT_NE(e.verdict, Verdict::ok) << i;
    }
    if (i >= kFirstGood + (fault.may_align ? 6 : 2)) {
      EXPECT_EQ(e.verdict, Verdict::ok) << i;
    }
    variance = now;
    if (mode == Mode::recommended && i >= 10 && !fault.may_align) {
      EXPECT_LT(position_nees(e, flight.truth(i)), 25) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Navigator, BadFrames,
                         testing::Combine(testing::Values(Mode::paper, Mode::recommended),
                                          testing::ValuesIn(kFaults)),
                         [](const auto& test) {
                           return std::string(name_of(std::get<0>(test.param))) + "_" +
                                  std::get<1>(test.param).name;
                         });

class BadTimestamps : public testing::TestWithParam<Mode> {};

TEST_P(BadTimestamps, RejectsFrozenImage) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator({}, GetParam());
  double variance = 0;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    Frame frame = flight.frames[i];
    const bool frozen = i >= kFirstBad && i < kFirstGood;
    if (frozen) frame.grey = flight.frames[kFirstBad - 1].grey.clone();
    const NavigationEstimate e = navigator.step(frame);
    const double now = e.pose_covariance.topLeftCorner<3, 3>().trace();
    if (frozen) {
      EXPECT_EQ(e.verdict, Verdict::frozen);
      EXPECT_GT(now, variance);
      EXPECT_GT(e.velocity_in_world_m_s.norm(), 2);  // velocity is predicted
    }
    variance = now;
  }
}

TEST_P(BadTimestamps, RejectsDescendingStamp) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator({}, GetParam());
  for (std::size_t i = 0; i < kFirstBad; ++i) (void)navigator.step(flight.frames[i]);
  Frame old = flight.frames[kFirstBad];
  old.stamp = flight.frames[3].stamp;
  EXPECT_EQ(navigator.step(old).verdict, Verdict::time_gap);
  const NavigationEstimate e = navigator.step(flight.frames[kFirstBad + 1]);
  EXPECT_TRUE(is_finite(e));
  EXPECT_EQ(e.verdict, Verdict::ok);
}

TEST_P(BadTimestamps, DoesNotIntegrateAcrossLongGap) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator({}, GetParam());
  NavigationEstimate before;
  for (std::size_t i = 0; i < kFirstBad; ++i) before = navigator.step(flight.frames[i]);
  constexpr std::int64_t kHour_ns = 3600'000'000'000;
  for (std::size_t i = kFirstBad; i < flight.frames.size(); ++i) {
    Frame late = flight.frames[i];
    late.stamp.ns += kHour_ns;
    const NavigationEstimate e = navigator.step(late);
    ASSERT_TRUE(is_finite(e));
    EXPECT_EQ(e.verdict, i == kFirstBad ? Verdict::time_gap : Verdict::ok) << i;
    const Eigen::Vector3d displacement_m =
        e.world_from_body.translation - before.world_from_body.translation;
    EXPECT_LT(displacement_m.norm(), 25);
    EXPECT_GT(e.pose_covariance(0, 0), 1e6);
  }
}

TEST_P(BadTimestamps, ThrowsOnWrongImageSize) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator({}, GetParam());
  Frame small = flight.frames[0];
  small.grey = small.grey(cv::Rect(0, 0, 320, 180)).clone();
  EXPECT_THROW((void)navigator.step(small), InputError);
}

INSTANTIATE_TEST_SUITE_P(Navigator, BadTimestamps, testing::Values(Mode::paper, Mode::recommended),
                         [](const auto& mode) { return std::string(name_of(mode.param)); });

// Lost images without a gap in the stamps: the camera jumps by 2.4 m.
TEST(BadFrame, PositionJumpMakesTheVelocityUncertain) {
  const auto& flight = rendered_flight();
  constexpr std::size_t kFirstShifted = 30;
  constexpr std::size_t kLostFrames = 10;
  for (const Policy policy : {Policy::flow, Policy::best, Policy::fused}) {
    SCOPED_TRACE(name_of(policy));
    Navigator navigator(flight.record.camera, flight.record.body_from_camera, {}, flight.start(),
                        {.policy = policy});
    for (std::size_t i = 0; i + kLostFrames < flight.frames.size(); ++i) {
      const std::size_t shown = i < kFirstShifted ? i : i + kLostFrames;
      const Frame frame{flight.frames[i].stamp, flight.frames[i].index, flight.frames[shown].grey};
      const NavigationEstimate e = navigator.step(frame);
      if (i < kFirstShifted - 1) continue;
      EXPECT_LT(e.velocity_in_world_m_s.norm(), 10) << i;
      if (i == kFirstShifted) {
        EXPECT_GT(e.twist_covariance(0, 0), 4) << "velocity is not observed";
        EXPECT_TRUE(policy == Policy::fused || e.velocity_in_world_m_s.norm() > 3)
            << "an unobserved velocity is not zero";
      }
      if (i <= kFirstShifted + 1) continue;
      const Eigen::Vector3d error = e.world_from_body.translation - flight.truth(shown).translation;
      EXPECT_LT(error.norm(), 0.15) << i;
      EXPECT_LT(position_nees(e, flight.truth(shown)), 25) << i;
    }
  }
}

// The sums over a textureless image contain rounding errors only.
TEST(BadFrame, RejectsTexturelessImageAtAnyTime) {
  const auto& flight = rendered_flight();
  for (const Policy policy : {Policy::flow, Policy::reference}) {
    for (const double grey : {0.0, 77.0, 255.0}) {
      for (std::size_t first = 1; first <= 3; ++first) {
        Navigator navigator(flight.record.camera, flight.record.body_from_camera, {},
                            flight.start(), {.policy = policy});
        for (std::size_t i = 0; i < flight.frames.size(); ++i) {
          Frame frame = flight.frames[i];
          const bool is_textureless = i >= first && (i - first) % 3 == 0;
          if (is_textureless) frame.grey = cv::Mat(frame.grey.size(), CV_8UC1, cv::Scalar(grey));
          const Verdict verdict = navigator.step(frame).verdict;
          if (is_textureless) {
            EXPECT_NE(verdict, Verdict::ok) << i << ' ' << grey;
          }
        }
      }
    }
  }
}

TEST(BadFrame, ReplacesTexturelessFirstImage) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator();
  Frame black = flight.frames[0];
  black.grey = cv::Mat(black.grey.size(), CV_8UC1, cv::Scalar(0));
  (void)navigator.step(black);
  EXPECT_NE(navigator.step(flight.frames[1]).verdict, Verdict::ok);
  for (std::size_t i = 2; i < 12; ++i) {
    EXPECT_EQ(navigator.step(flight.frames[i]).verdict, Verdict::ok) << i;
  }
}

TEST(BadFrame, ToleratesExposureStep) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator();
  NavigationEstimate e;
  for (std::size_t i = 0; i < flight.frames.size(); ++i) {
    Frame frame = flight.frames[i];
    if (i >= 20) frame.grey = cv::Mat(0.7 * frame.grey);
    e = navigator.step(frame);
    if (i > 0) {
      EXPECT_EQ(e.verdict, Verdict::ok) << i;
    }
  }
  const RigidTransform& truth = flight.truth(flight.frames.size() - 1);
  EXPECT_LT((e.world_from_body.translation - truth.translation).norm(), 0.05);
}

// Three seconds in the dark, longer than `max_gap_s`: the flight resumes at the former position,
// within the covariance.
TEST(BadFrame, RecoversAfterOcclusion) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator();
  std::int64_t ns = 0;
  const auto step = [&](const cv::Mat& grey) {
    ns += 40'000'000;
    return navigator.step({Timestamp{ns}, ns / 40'000'000, grey});
  };
  for (std::size_t i = 0; i <= 20; ++i) (void)step(flight.frames[i].grey);
  for (int k = 0; k < 75; ++k) {
    const NavigationEstimate e =
        step(cv::Mat(flight.frames[0].grey.size(), CV_8UC1, cv::Scalar(k % 3)));
    EXPECT_EQ(e.verdict, Verdict::too_little_texture) << k;
    ASSERT_TRUE(is_finite(e));
  }
  for (std::size_t i = 21; i < flight.frames.size(); ++i) {
    const NavigationEstimate e = step(flight.frames[i].grey);
    ASSERT_TRUE(is_finite(e));
    ASSERT_EQ(e.verdict, Verdict::ok) << i;
    EXPECT_LT((e.world_from_body.translation - flight.truth(i).translation).norm(), 0.1) << i;
    if (i < 24) continue;
    const Twist& truth = flight.record.twists_in_camera[i - 1].twist;
    EXPECT_LT((e.twist_in_camera.velocity_m_s - truth.velocity_m_s).norm(), 0.3) << i;
  }
}

// The velocity's error lasts: the position's grows with the time, through keyframes that are taken
// without a measurement.
TEST(BadFrame, PositionCovarianceOfALongLossGrowsWithTheVelocity) {
  const auto& flight = rendered_flight();
  Navigator navigator = flight.navigator();
  NavigationEstimate e;
  for (std::size_t i = 0; i <= 20; ++i) e = navigator.step(flight.frames[i]);
  const double speed_m_s = e.velocity_in_world_m_s.norm();
  int keyframes = 0;
  constexpr int kFrames = 100;
  for (int k = 1; k <= kFrames; ++k) {
    cv::Mat noise(flight.frames[0].grey.size(), CV_8UC1);
    cv::randn(noise, 128, 40);
    e = navigator.step({from_seconds(0.04 * (20 + k)), 20 + k, noise});
    EXPECT_NE(e.verdict, Verdict::ok) << k;
    keyframes += e.new_keyframe ? 1 : 0;
  }
  EXPECT_GT(keyframes, 5);
  const double held_s = 0.04 * kFrames - TrustConfig{}.max_gap_s;
  EXPECT_GT(std::sqrt(e.pose_covariance(0, 0)), 0.9 * speed_m_s * held_s);
  EXPECT_LT(std::sqrt(e.pose_covariance(0, 0)), 2 * speed_m_s * held_s);
}

// After 1.5 s of a repeated image the view has moved by a third of the image.
TEST(BadFrame, RelocalizesDistantKeyframe) {
  double nees = 0;
  int found = 0;
  for (const int seed : {1, 2, 3, 4}) {
    SimulationConfig config = test::small_flight(seed);
    config.flight.height_m = 20;
    const test::RenderedFlight flight = test::render_flight(config);
    Navigator navigator = flight.navigator();
    const std::size_t last = flight.frames.size() - 1;
    for (std::size_t i = 0; i < last; ++i) {
      Frame frame = flight.frames[i];
      frame.grey = flight.frames[std::min<std::size_t>(i, 14)].grey;
      (void)navigator.step(frame);
    }
    const NavigationEstimate e = navigator.step(flight.frames[last]);
    if (e.verdict != Verdict::ok) continue;
    ++found;
    nees += position_nees(e, flight.truth(last));
  }
  EXPECT_GE(found, 3);
  EXPECT_LT(nees / found, 10);
}

}  // namespace
}  // namespace stillkite
