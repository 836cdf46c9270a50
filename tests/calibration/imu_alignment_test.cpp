#include "calibration/imu_alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "geometry/angle.hpp"
#include "geometry/fields.hpp"
#include "geometry/rigid_transform.hpp"

namespace stillkite {
namespace {

constexpr double kDensity = 2e-4;

struct RotationScene {
  Eigen::Quaterniond imu_from_camera = so3_exp({1.1, -0.4, 2.0});
  Eigen::Vector3d bias_rad_s{0.01, -0.02, 0.07};
  double offset_s = 0.013;
  double rate_rad_s = 0.5;
  double focal_ratio = 1;
  double about_z = 1;  // share of the rotation about the IMU's z
};

// Angular rate of the IMU, sums of sines.
Eigen::Vector3d rate_at(const RotationScene& scene, double t_s) {
  const double z = std::sin(3.1 * t_s + 2) + 0.3 * std::cos(7 * t_s);
  return scene.rate_rad_s *
         Eigen::Vector3d(std::sin(4 * t_s), std::sin(5.3 * t_s + 1), scene.about_z * z);
}

struct Recording {
  std::vector<ImagePair> pairs;
  std::vector<Timestamp> stamps;
  std::vector<Eigen::Vector3d> rates_rad_s;
  [[nodiscard]] GyroReadings gyro() const { return {stamps, rates_rad_s}; }
};

// Ten seconds; translation 5 % of the depth between two images, bearings of 0.3 px at f = 450 px.
Recording record(const RotationScene& scene, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double sigma) -> Eigen::Vector3d {
    return sigma * Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  constexpr double kStep_s = 0.005, kFine_s = 0.001, kInterval_s = 0.15, kSigma = 0.3 / 450;
  Recording out;
  for (int i = -40; i < 2080; ++i) {
    const double t_s = kStep_s * i;
    // the IMU's clock is ahead of the images'
    out.stamps.push_back(from_seconds(t_s + scene.offset_s));
    out.rates_rad_s.emplace_back(rate_at(scene, t_s) + scene.bias_rad_s +
                                 vector(kDensity / std::sqrt(kStep_s)));
  }
  std::uniform_real_distribution<double> place(-0.6, 0.6), depth(3, 8);
  for (int k = 0; k < 66; ++k) {
    const double begin_s = kInterval_s * k;
    Eigen::Quaterniond imu_rotation = Eigen::Quaterniond::Identity();
    for (int i = 0; i < 150; ++i) {
      imu_rotation =
          imu_rotation * so3_exp(kFine_s * rate_at(scene, begin_s + (i + 0.5) * kFine_s));
    }
    const RigidTransform first_from_second{
        scene.imu_from_camera.conjugate() * imu_rotation * scene.imu_from_camera, vector(0.15)};
    const RigidTransform second_from_first = first_from_second.inverse();
    ImagePair pair{from_seconds(begin_s), from_seconds(begin_s + kInterval_s), {}};
    while (pair.matches.size() < 100) {
      const double z_m = depth(random);
      const Eigen::Vector3d point(place(random) * z_m, place(random) * z_m, z_m);
      const Eigen::Vector3d in_second = second_from_first * point;
      if (in_second.z() < 1) continue;
      const auto bearing = [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
        const Eigen::Vector2d at = x.hnormalized() + vector(kSigma).head<2>();
        // bearings of a focal length that is too small
        return (scene.focal_ratio * at).homogeneous();
      };
      pair.matches.push_back({bearing(point), bearing(in_second), kSigma * kSigma});
    }
    out.pairs.push_back(pair);
  }
  return out;
}

TEST(GyroReadings, DerivativesAgreeWithDifferences) {
  const Recording recording = record({}, 1);
  const GyroReadings gyro = recording.gyro();
  const Timestamp from = from_seconds(1.0021), to = from_seconds(1.1533);
  const Eigen::Vector3d bias(0.02, 0.01, -0.03);
  const auto at = gyro.between(from, to, 0.01, bias);
  ASSERT_TRUE(at);
  const auto difference = [&](const GyroRotation& moved, double step) -> Eigen::Vector3d {
    return so3_log(Eigen::Quaterniond(at->rotation.transpose() * moved.rotation)) / step;
  };
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const auto moved = gyro.between(from, to, 0.01, bias + kStep * Eigen::Vector3d::Unit(i));
    EXPECT_LT((difference(*moved, kStep) - at->by_bias.col(i)).norm(), 1e-4);
  }
  EXPECT_LT((difference(*gyro.between(from, to, 0.01 + kStep, bias), kStep) - at->by_offset).norm(),
            1e-4);
  EXPECT_FALSE(gyro.between(from_seconds(-10), to, 0, bias));
  EXPECT_FALSE(gyro.between(from, from_seconds(100), 0, bias));
}

TEST(ImuAlignment, FindsRotationBiasAndOffset) {
  for (const double offset_s : {0.013, -0.21}) {
    const RotationScene scene{.offset_s = offset_s};
    const Recording recording = record(scene, 2);
    const ImuAlignment alignment =
        align_imu(recording.pairs, recording.gyro(), {.gyro_density = kDensity});
    EXPECT_LT(angle_between_rad(alignment.imu_from_camera, scene.imu_from_camera), 0.3 * kDegree);
    EXPECT_NEAR(alignment.time_offset_s, offset_s, 0.002);
    EXPECT_LT((alignment.gyro_bias_rad_s - scene.bias_rad_s).norm(), 0.002);
  }
}

// Two axes determine the rotation: the third follows, as no mirrored one is possible.
TEST(ImuAlignment, FindsRotationByTwoAxes) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const RotationScene scene{.about_z = 0};
    const Recording recording = record(scene, seed);
    const ImuAlignment alignment =
        align_imu(recording.pairs, recording.gyro(), {.gyro_density = kDensity});
    EXPECT_LT(angle_between_rad(alignment.imu_from_camera, scene.imu_from_camera), 0.3 * kDegree);
  }
}

TEST(ImuAlignment, CovarianceIsConsistent) {
  constexpr int kDraws = 20;
  const RotationScene scene;
  double nees = 0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const Recording recording = record(scene, seed);
    const ImuAlignment alignment =
        align_imu(recording.pairs, recording.gyro(), {.gyro_density = kDensity});
    Eigen::Matrix<double, 7, 1> error;
    error << so3_log(scene.imu_from_camera * alignment.imu_from_camera.conjugate()),
        scene.bias_rad_s - alignment.gyro_bias_rad_s, scene.offset_s - alignment.time_offset_s;
    const Eigen::Matrix<double, 7, 7> P = alignment.covariance.topLeftCorner<7, 7>();
    nees += error.dot(P.ldlt().solve(error));
  }
  // chi square of 140 degrees of freedom; robust weights cost some efficiency
  EXPECT_NEAR(nees / (7 * kDraws), 1.0, 0.5);
}

TEST(ImuAlignment, RefusesMirroredAxes) {
  Recording recording = record({}, 3);
  for (Eigen::Vector3d& rate : recording.rates_rad_s) rate.y() = -rate.y();
  try {
    (void)align_imu(recording.pairs, recording.gyro(), {.gyro_density = kDensity});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("mirrored axes"), std::string::npos) << error.what();
  }
}

TEST(ImuAlignment, RefusesAFlightWithoutRotation) {
  const Recording recording = record({.rate_rad_s = 1e-4}, 4);
  EXPECT_THROW((void)align_imu(recording.pairs, recording.gyro(), {.gyro_density = kDensity}),
               InputError);
}

TEST(ImuAlignment, RefusesAnotherFlight) {
  const Recording recording = record({}, 5);
  Recording other = record({}, 5);
  std::mt19937 random(1);
  std::shuffle(other.rates_rad_s.begin(), other.rates_rad_s.end(), random);
  EXPECT_THROW((void)align_imu(recording.pairs, other.gyro(), {.gyro_density = kDensity}),
               InputError);
}

TEST(ImuAlignment, FindsTheFocalLength) {
  const RotationScene scene{.focal_ratio = 1.1};
  const Recording recording = record(scene, 6);
  const ImuAlignment alignment = align_imu(recording.pairs, recording.gyro(),
                                           {.gyro_density = kDensity, .estimate_focal = true});
  EXPECT_NEAR(alignment.focal_ratio, 1.1, 0.01);
  EXPECT_NEAR(std::log(alignment.focal_ratio / 1.1) / std::sqrt(alignment.covariance(7, 7)), 0, 4);
}

}  // namespace
}  // namespace stillkite
