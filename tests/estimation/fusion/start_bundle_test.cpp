#include "estimation/fusion/start_bundle.hpp"

#include <gtest/gtest.h>

#include <random>

#include "estimation/fusion/landmark_model.hpp"

namespace stillkite {
namespace {

// Points before a camera that moves to one side and turns a little, each seen in every frame.
struct BundleScene {
  static constexpr std::size_t kFrames = 6;
  static constexpr std::size_t kPoints = 30;
  RigidTransform anchor{so3_exp({0.1, -0.4, 0.2}), {1, 2, 3}};
  std::vector<RigidTransform> way;
  std::vector<StartCandidate> candidates;
  std::vector<double> inverse_depths;
  std::vector<ToldFrame> frames;
  std::vector<std::size_t> chosen;

  explicit BundleScene(double noise = 0) {
    constexpr double kSigma = 1e-3;
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Eigen::Vector2d bearing(0.8 * uniform(engine), 0.5 * uniform(engine));
      candidates.push_back(
          {.reference = {.feature = static_cast<int>(i),
                         .bearing = bearing,
                         .covariance = kSigma * kSigma * Eigen::Matrix2d::Identity()},
           .guess = 0.2});
      inverse_depths.push_back(0.2 + 0.1 * uniform(engine));
    }
    frames.resize(kFrames);
    for (std::size_t k = 0; k < kFrames; ++k) {
      const double t = static_cast<double>(k + 1);
      way.push_back({so3_exp({0.002 * t, -0.001 * t, 0.003}) * anchor.rotation,
                     anchor.translation + Eigen::Vector3d(0.05 * t, 0.002 * t * t, -0.01 * t)});
      chosen.push_back(k);
      for (std::size_t i = 0; i < kPoints; ++i) {
        FeatureView view = candidates[i].reference;
        view.bearing = project_landmark(way[k], anchor, view.bearing, inverse_depths[i])->bearing +
                       noise * kSigma * Eigen::Vector2d(normal(engine), normal(engine));
        frames[k].seen.push_back(view);
      }
    }
  }

  // Independent errors of all poses about poses that are off from the true ones.
  [[nodiscard]] StartPrior prior(double pose_sigma, double pose_error) const {
    StartPrior out;
    std::mt19937_64 engine(7);
    std::normal_distribution<double> normal;
    const auto off = [&]() -> Eigen::Vector3d {
      return pose_error * Eigen::Vector3d(normal(engine), normal(engine), normal(engine));
    };
    for (const RigidTransform& pose : way) {
      const Eigen::Vector3d turn = off();
      out.world_from_camera.push_back({so3_exp(turn) * pose.rotation, pose.translation + off()});
    }
    out.world_from_camera.push_back(anchor);
    constexpr Eigen::Index kSize = 6 * kFrames;
    out.covariance = pose_sigma * pose_sigma * Eigen::MatrixXd::Identity(kSize + 6, kSize);
    return out;
  }

  [[nodiscard]] StartBundle bundle(const FusionConfig& config, StartPrior prior) const {
    std::vector<ToldFrame> all = frames;
    all.emplace_back();
    return {config, std::move(prior), kFrames, all, chosen, candidates};
  }
};

FusionConfig lasting_windows() {
  FusionConfig config;
  config.window_error_way = 1e6;
  return config;
}

void settle(const StartBundle& bundle, StartEstimate& estimate) {
  for (int i = 0; i < 20 && !(estimate.step < 1e-9); ++i) bundle.step(estimate);
  EXPECT_LT(estimate.step, 1e-9);
}

// Where the poses are known the depths are in the images.
TEST(StartBundle, FindsThePointsOfExactViews) {
  const BundleScene scene;
  FusionConfig config = lasting_windows();
  config.inverse_depth_sigma_ratio = 100;
  const StartBundle bundle = scene.bundle(config, scene.prior(1e-9, 0));
  StartEstimate estimate = bundle.begin(std::vector<double>(BundleScene::kPoints, 0.2));
  settle(bundle, estimate);
  for (std::size_t i = 0; i < BundleScene::kPoints; ++i) {
    EXPECT_NEAR(estimate.points[i].inverse_depth, scene.inverse_depths[i], 1e-5) << i;
  }
  const std::vector<RigidTransform> way = bundle.way(estimate);
  for (std::size_t k = 0; k < BundleScene::kFrames; ++k) {
    EXPECT_LT((way[k].translation - scene.way[k].translation).norm(), 1e-6);
    EXPECT_LT(way[k].rotation.angularDistance(scene.way[k].rotation), 1e-6);
  }
}

// A start that has been told from others is not to be drawn towards its guesses by all of them.
TEST(StartBundle, GuessesCountLessOnceAllPointsJoin) {
  const BundleScene scene;
  FusionConfig config = lasting_windows();
  config.inverse_depth_sigma_ratio = 0.05;
  const StartBundle bundle = scene.bundle(config, scene.prior(1e-9, 0));
  StartEstimate estimate = bundle.begin(std::vector<double>(BundleScene::kPoints, 0.2));
  const auto off = [&] {
    settle(bundle, estimate);
    double sum = 0;
    for (std::size_t i = 0; i < BundleScene::kPoints; ++i) {
      sum += std::abs(estimate.points[i].inverse_depth - scene.inverse_depths[i]);
    }
    return sum;
  };
  const double before = off();
  EXPECT_FALSE(bundle.add_rest(estimate));
  estimate.step = HUGE_VAL;
  EXPECT_LT(off(), 0.4 * before);
}

double sum_of_squares(const BundleScene& scene, const FusionConfig& config, const StartPrior& prior,
                      double pose_sigma, const StartEstimate& at) {
  double sum = 0;
  for (std::size_t k = 0; k < BundleScene::kFrames; ++k) {
    const RigidTransform& mean = prior.world_from_camera[k];
    const RigidTransform& pose = at.world_from_camera[k];
    sum += (so3_log(mean.rotation * pose.rotation.conjugate()).squaredNorm() +
            (mean.translation - pose.translation).squaredNorm()) /
           square(pose_sigma);
  }
  for (std::size_t i = 0; i < at.points.size(); ++i) {
    const StartCandidate& candidate = scene.candidates[i];
    const StartEstimate::Point& point = at.points[i];
    const double variance = candidate.reference.covariance(0, 0);
    sum += (point.bearing - candidate.reference.bearing).squaredNorm() / variance +
           square((point.inverse_depth - candidate.guess) /
                  (config.inverse_depth_sigma_ratio * candidate.guess));
    for (std::size_t k = 0; k < BundleScene::kFrames; ++k) {
      const auto seen = project_landmark(at.world_from_camera[k], scene.anchor, point.bearing,
                                         point.inverse_depth);
      sum += (scene.frames[k].seen[i].bearing - seen->bearing).squaredNorm() / variance;
    }
  }
  return sum;
}

// Wherever a point or a pose is moved from there, the sum of squares grows.
TEST(StartBundle, SettlesWhereTheSumOfSquaresIsLeast) {
  constexpr double kPoseSigma = 0.02;
  const BundleScene scene(1);
  const FusionConfig config = lasting_windows();
  const StartPrior prior = scene.prior(kPoseSigma, kPoseSigma);
  const StartBundle bundle = scene.bundle(config, prior);
  StartEstimate estimate = bundle.begin(std::vector<double>(BundleScene::kPoints, 0.2));
  settle(bundle, estimate);
  const auto sum = [&](const StartEstimate& at) {
    return sum_of_squares(scene, config, prior, kPoseSigma, at);
  };
  const double least = sum(estimate);
  constexpr double kStep = 1e-4;
  for (const double step : {-kStep, kStep}) {
    StartEstimate beside = estimate;
    beside.points[4].inverse_depth += step;
    EXPECT_GT(sum(beside), least);
    beside = estimate;
    beside.points[5].bearing.x() += step;
    EXPECT_GT(sum(beside), least);
    beside = estimate;
    beside.world_from_camera[2].translation.y() += step;
    EXPECT_GT(sum(beside), least);
    beside = estimate;
    beside.world_from_camera[3].rotation =
        so3_exp({0, step, 0}) * beside.world_from_camera[3].rotation;
    EXPECT_GT(sum(beside), least);
  }
}

TEST(StartBundle, WeighsAPointThatStrays) {
  BundleScene scene(1);
  for (std::size_t k = 0; k < BundleScene::kFrames; ++k) {
    scene.frames[k].seen[7].bearing.y() += 3e-3 * static_cast<double>(k);
  }
  const StartBundle bundle = scene.bundle(lasting_windows(), scene.prior(0.01, 0.01));
  StartEstimate estimate = bundle.begin(std::vector<double>(BundleScene::kPoints, 0.2));
  settle(bundle, estimate);
  bundle.weigh(estimate);
  double others = 0;
  for (std::size_t i = 0; i < BundleScene::kPoints; ++i) {
    if (i != 7) others = std::max(others, estimate.points[i].stray.value());
  }
  EXPECT_GT(estimate.points[7].stray.value(), 1.3);
  EXPECT_LT(others, estimate.points[7].stray.value());
}

TEST(StartBundle, GivesUpWhereAPointIsBehindTheCamera) {
  const BundleScene scene;
  const StartBundle bundle = scene.bundle(lasting_windows(), scene.prior(0.01, 0));
  std::vector<double> inverse_depths(BundleScene::kPoints, 0.2);
  const Eigen::Vector2d bearing = scene.candidates[3].reference.bearing;
  inverse_depths[3] = project_landmark(scene.way[5], scene.anchor, bearing, 1e4) ? -1e4 : 1e4;
  StartEstimate estimate = bundle.begin(inverse_depths);
  bundle.step(estimate);
  EXPECT_FALSE(std::isfinite(estimate.cost));
  EXPECT_FALSE(std::isfinite(estimate.step));
}

}  // namespace
}  // namespace stillkite
