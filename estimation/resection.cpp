#include "estimation/resection.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "estimation/landmark_model.hpp"

namespace stillkite {

std::optional<Resection> resection(FusionState state, const std::vector<Landmark>& landmarks,
                                   std::span<const FeatureView> seen) {
  constexpr int kSteps = 5;
  constexpr std::size_t kFewest = 6;
  constexpr int kColumn = FusionIndex::kLandmarks;
  Eigen::MatrixXd of_pose = Eigen::MatrixXd::Zero(kColumn + 3, 6);
  of_pose.topRows<6>().setIdentity();
  Resection out;
  for (int step = 0; step < kSteps; ++step) {
    Matrix6d N = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    std::size_t count = 0;
    for (const FeatureView& view : seen) {
      const auto landmark =
          std::find_if(landmarks.begin(), landmarks.end(),
                       [&](const Landmark& l) { return l.feature == view.feature; });
      if (landmark == landmarks.end()) continue;
      const auto innovation =
          landmark_innovation(state, *landmark, kColumn, view.bearing, view.covariance);
      if (!innovation) continue;
      const Eigen::Matrix<double, 2, 6> H = innovation->H.times(of_pose);
      const Eigen::Matrix<double, 2, 6> weighted = view.covariance.llt().solve(H);
      N += H.transpose() * weighted;
      b += weighted.transpose() * innovation->residual;
      ++count;
    }
    const Vector6d x = N.ldlt().solve(b);
    if (count < kFewest || !x.allFinite()) return std::nullopt;
    RigidTransform& pose = state.world_from_camera;
    pose.rotation = (so3_exp(x.head<3>()) * pose.rotation).normalized();
    pose.translation += x.tail<3>();
    out = {.world_from_camera = pose, .information = N};
  }
  return out;
}

}  // namespace stillkite
