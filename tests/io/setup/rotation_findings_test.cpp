#include "io/setup/rotation_findings.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "geometry/angle.hpp"
#include "geometry/rigid_transform.hpp"
#include "io/setup/axes_comparison.hpp"

namespace stillkite {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d rate_rad_s(double t_s) {
  return {0.2 * std::sin(1.3 * t_s), 0.15 * std::cos(2.1 * t_s + 1), 0.3 * std::sin(0.7 * t_s + 2)};
}

// Body from a camera that looks down, image up forward.
Quaterniond nadir() {
  Matrix3d R;
  R.col(0) << 0, -1, 0;
  R.col(1) << -1, 0, 0;
  R.col(2) << 0, 0, -1;
  return Quaterniond(R);
}

// 20 s over ground; image noise of 1 mrad per frame and axis, gyroscope with a bias.
struct Flight {
  TimeSeries<Vector3d> gyro;
  std::vector<ObservedRotation> observed;
  Quaterniond body_from_camera = nadir();
  Vector3d measured_up = Vector3d::UnitZ();
  double time_offset_s = 0;

  Flight() {
    std::mt19937 random(1);
    std::normal_distribution<double> error(0, 1e-3);
    for (int i = -1000; i <= 5000; ++i) {
      gyro.stamps.push_back(from_seconds(100 + 0.005 * i));
      gyro.values.emplace_back(rate_rad_s(0.005 * i) + Vector3d(0.03, -0.08, 0.05));
    }
    for (int i = 1; i <= 500; ++i) {
      observed.push_back({from_seconds(100 + 0.04 * (i - 1)), from_seconds(100 + 0.04 * i),
                          0.04 * rate_rad_s(0.04 * i - 0.02) +
                              Vector3d(error(random), error(random), error(random))});
    }
  }

  [[nodiscard]] RotationResult result() const {
    return rotation_findings({.gyro = gyro,
                              .observed = observed,
                              .body_from_camera = body_from_camera,
                              .time_offset_s = time_offset_s,
                              .measured_up_in_body = measured_up,
                              .has_ground_in_view = true,
                              .first = observed.front().from,
                              .last = observed.back().to});
  }
};

SetupFinding finding(const RotationResult& result, const std::string& question) {
  const auto found = std::ranges::find(result.findings, question, &SetupFinding::question);
  return found == result.findings.end() ? SetupFinding{.question = "absent"} : *found;
}

std::string wrong_questions(const RotationResult& result) {
  std::string out;
  for (const SetupFinding& f : result.findings) {
    if (f.verdict == SetupVerdict::wrong || f.verdict == SetupVerdict::doubtful) {
      out += f.question + ";";
    }
  }
  return out;
}

TEST(RotationFindings, SignedPermutationsAreThe48OfACube) {
  int rotations = 0;
  for (const Matrix3d& axes : signed_permutations()) {
    EXPECT_LT((axes * axes.transpose() - Matrix3d::Identity()).norm(), 1e-15);
    rotations += axes.determinant() > 0 ? 1 : 0;
  }
  EXPECT_EQ(signed_permutations().size(), 48u);
  EXPECT_EQ(rotations, 24);
  EXPECT_TRUE(signed_permutations().front().isIdentity());
}

TEST(RotationFindings, AccuseNothingOfACorrectFlight) {
  const RotationResult result = Flight().result();
  EXPECT_EQ(wrong_questions(result), "");
  EXPECT_TRUE(result.is_consistent);
  EXPECT_LT((result.gyro_bias_rad_s - Vector3d(0.03, -0.08, 0.05)).norm(), 4e-3);
  for (const char* question : {"imu rates", "imu axes", "imu clock", "mount", "focal length"}) {
    EXPECT_EQ(finding(result, question).verdict, SetupVerdict::ok) << question;
  }
}

// Every rotation of the cube, of the IMU: rates and forces. Its quaternion is in the remedy.
TEST(RotationFindings, FindsEachOfThe24AxesOfAnImu) {
  for (const Matrix3d& axes : signed_permutations()) {
    if (axes.determinant() < 0 || axes.isIdentity()) continue;
    Flight flight;
    for (Vector3d& rate : flight.gyro.values) rate = axes.transpose() * rate;
    flight.measured_up = axes.transpose() * flight.measured_up;
    const RotationResult result = flight.result();
    const bool is_about_vertical = (axes * Vector3d::UnitZ()).z() > 0.5;
    EXPECT_EQ(wrong_questions(result), "imu axes;") << axes;
    Quaterniond q(axes);
    if (q.w() < 0) q.coeffs() *= -1;
    const std::string remedy = finding(result, "imu axes").remedy;
    const std::string line = remedy.substr(remedy.find('[') + 1);
    double w = 0, x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf, %lf, %lf, %lf", &w, &x, &y, &z), 4) << remedy;
    EXPECT_LT(angle_between_rad(Quaterniond(w, x, y, z).normalized(), q), 0.01) << remedy;
    EXPECT_EQ(remedy.find("mount") != std::string::npos, is_about_vertical) << remedy;
  }
}

TEST(RotationFindings, NamesSwappedColumns) {
  Flight flight;
  for (Vector3d& rate : flight.gyro.values) std::swap(rate.x(), rate.y());
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "imu axes;");
  EXPECT_NE(finding(result, "imu axes").remedy.find("x = y, y = x, z = z"), std::string::npos);
}

// p = M g in the body as configured: the mount M^T C is the true one.
TEST(RotationFindings, FindsARotatedMount) {
  Flight flight;
  const Quaterniond error = so3_exp(Vector3d(0, 50 * kDegree, 0));
  flight.body_from_camera = error * nadir();
  for (ObservedRotation& rotation : flight.observed) {
    rotation.rotation_in_body_rad = error * rotation.rotation_in_body_rad;
  }
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "mount;");
  const std::string remedy = finding(result, "mount").remedy;
  double w = 0, x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(remedy.substr(remedy.find('[') + 1).c_str(), "%lf, %lf, %lf, %lf", &w, &x,
                        &y, &z),
            4);
  EXPECT_LT(angle_between_rad(Quaterniond(w, x, y, z).normalized(), nadir()), 0.03) << remedy;
}

TEST(RotationFindings, FindsAMountRotatedBySixDegrees) {
  Flight flight;
  const Quaterniond error = so3_exp(Vector3d(6 * kDegree, 0, 0));
  for (ObservedRotation& rotation : flight.observed) {
    rotation.rotation_in_body_rad = error * rotation.rotation_in_body_rad;
  }
  const RotationResult result = flight.result();
  EXPECT_EQ(finding(result, "mount").verdict, SetupVerdict::doubtful);
  const SetupMeasurement angle = *finding(result, "mount").measured;
  EXPECT_NEAR(angle.value, 6, 4 * *angle.sigma);
  EXPECT_LT(*angle.sigma, 0.3);
}

// Mirrored left-right: the angular rate, an axial vector, becomes (x, -y, -z) in the camera.
TEST(RotationFindings, DistinguishesMirroredImagesFromAMount) {
  Flight flight;
  const Matrix3d C = nadir().toRotationMatrix();
  const Matrix3d mirrored = C * Vector3d(1, -1, -1).asDiagonal() * C.transpose();
  for (ObservedRotation& rotation : flight.observed) {
    rotation.rotation_in_body_rad = mirrored * rotation.rotation_in_body_rad;
  }
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "mirrored images;");
  EXPECT_NE(finding(result, "mirrored images").remedy.find("hflip"), std::string::npos);
}

TEST(RotationFindings, FindsDegreesWithTheAxesAndTheClock) {
  Flight flight;
  for (Vector3d& rate : flight.gyro.values) rate /= kDegree;
  for (Timestamp& stamp : flight.gyro.stamps) stamp.ns += 200'000'000;
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "imu rates;imu clock;");
  EXPECT_NEAR(finding(result, "imu clock").measured->value, 0.2, 0.005);
}

TEST(RotationFindings, FindsAClockOffsetOf30Milliseconds) {
  Flight flight;
  flight.time_offset_s = 1;
  for (Timestamp& stamp : flight.gyro.stamps) stamp.ns += 30'000'000;
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "imu clock;");
  const SetupFinding clock = finding(result, "imu clock");
  EXPECT_NEAR(clock.measured->value, 0.03, 4 * *clock.measured->sigma);
  EXPECT_LT(*clock.measured->sigma, 0.005);
  EXPECT_EQ(clock.remedy, fmt::format("imu: {{time_offset_s: {:.3f}}}", 1 - clock.measured->value));
}

// The log begins 5 s before the images.
TEST(RotationFindings, MeasuresTheOffsetOfALogInGpsTime) {
  Flight flight;
  constexpr double kOffset_s = 1.4e9;
  for (Timestamp& stamp : flight.gyro.stamps) stamp.ns += std::llround(1e9 * kOffset_s);
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "imu clock;");
  const SetupFinding clock = finding(result, "imu clock");
  EXPECT_NEAR(clock.measured->value, kOffset_s, 0.01);
  EXPECT_NE(clock.text.find("no reading at any image"), std::string::npos) << clock.text;
}

TEST(RotationFindings, NamesLeapSeconds) {
  Flight flight;
  // a log of 60 s
  flight.gyro = {};
  for (int i = -6000; i <= 6000; ++i) {
    flight.gyro.stamps.push_back(from_seconds(118 + 0.005 * i));
    flight.gyro.values.push_back(rate_rad_s(0.005 * i));
  }
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "imu clock;");
  EXPECT_NE(finding(result, "imu clock").text.find("GPS time and UTC"), std::string::npos)
      << finding(result, "imu clock").text;
}

// Focal length of half the true one: rotations about x and y of the image are twice as large.
TEST(RotationFindings, MeasuresAWrongFocalLength) {
  Flight flight;
  for (ObservedRotation& rotation : flight.observed) {
    rotation.rotation_in_body_rad = Vector3d(2, 2, 1).asDiagonal() * rotation.rotation_in_body_rad;
  }
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "focal length;");
  EXPECT_NEAR(finding(result, "focal length").measured->value, 2, 0.02);
}

TEST(RotationFindings, CannotTellWithoutRotation) {
  Flight flight;
  for (ObservedRotation& rotation : flight.observed) rotation.rotation_in_body_rad *= 0.01;
  for (Vector3d& rate : flight.gyro.values) rate *= -0.01;
  const RotationResult result = flight.result();
  EXPECT_EQ(wrong_questions(result), "");
  EXPECT_EQ(finding(result, "imu axes").verdict, SetupVerdict::cannot_tell);
}

TEST(RotationFindings, CannotTellWhereTheImagesMeasureNoise) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 0.02);
    Flight flight;
    for (ObservedRotation& rotation : flight.observed) {
      rotation.rotation_in_body_rad = {noise(random), noise(random), noise(random)};
    }
    EXPECT_EQ(wrong_questions(flight.result()), "") << seed;
  }
}

}  // namespace
}  // namespace stillkite
