#include "estimation/sliding_window/pair_equations.hpp"

namespace stillkite {

PairEquations pair_equations(const Window& window, std::size_t host, std::size_t target,
                             const CameraPair& pair) {
  const PairJacobians by = pair_jacobians(pair);
  PairEquations out;
  out.target = target;
  out.by_shared.leftCols<ExtrinsicsIndex::kSize>() << by.by_extrinsics,
      by.by_host * window.frames[host].pose_rate() +
          by.by_target * window.frames[target].pose_rate();
  out.by_shared.rightCols<InertialIndex::kPoseSize>() = by.by_host;
  out.by_target = by.by_target;
  return out;
}

PairEquations ground_pair_equations(const Window& window, std::size_t host) {
  const GroundViewJacobians by = ground_view_jacobians(
      window.first_ground, window.frames[host].world_from_imu_after(window.image_shift_s(), true),
      window.first_extrinsics.imu_from_camera);
  PairEquations out;
  out.target = host;
  auto rows = out.by_shared.topRows<4>();
  rows.leftCols<ExtrinsicsIndex::kSize>() << by.by_extrinsics,
      by.by_pose * window.frames[host].pose_rate();
  rows.middleCols<GroundIndex::kSize>(SharedIndex::kGround) = by.by_plane;
  rows.rightCols<InertialIndex::kPoseSize>() = by.by_pose;
  return out;
}

}  // namespace stillkite
