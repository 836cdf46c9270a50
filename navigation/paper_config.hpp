#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "estimation/ego_motion/kalman_filter_config.hpp"
#include "estimation/ego_motion/least_squares_config.hpp"
#include "flow/dense_lucas_kanade_config.hpp"
#include "geometry/fields.hpp"

namespace stillkite {

/// Dense optical flow method: Lucas-Kanade of this project, or one of OpenCV's.
enum class DenseFlowMethod { lucas_kanade, farneback, dis_ultrafast, dis_fast, dis_medium };

template <>
struct EnumNames<DenseFlowMethod> {
  static constexpr auto value = std::to_array<std::pair<DenseFlowMethod, std::string_view>>(
      {{DenseFlowMethod::lucas_kanade, "lucas_kanade"},
       {DenseFlowMethod::farneback, "farneback"},
       {DenseFlowMethod::dis_ultrafast, "dis_ultrafast"},
       {DenseFlowMethod::dis_fast, "dis_fast"},
       {DenseFlowMethod::dis_medium, "dis_medium"}});
};

struct DenseFlowConfig {
  DenseFlowMethod method = DenseFlowMethod::lucas_kanade;
  int stride_px = 8;
  DenseLucasKanadeConfig lucas_kanade;

  static void fields(auto& self, auto&& field) {
    field("method", self.method, "dense optical flow method");
    field("stride_px", self.stride_px, Range{1, 256},
          "spacing of the flow vectors used by the least squares");
    field("lucas_kanade", self.lucas_kanade, "dense Lucas-Kanade");
  }
};

/// Integration of the velocities: Euler steps of position and angles as in the paper, or the closed
/// form for a constant twist.
enum class Integration { euler, exact };

template <>
struct EnumNames<Integration> {
  static constexpr auto value = std::to_array<std::pair<Integration, std::string_view>>(
      {{Integration::euler, "euler"}, {Integration::exact, "exact"}});
};

/// Procedure of the flow paper, section 4, with the defaults of its section 5.1.
struct PaperConfig {
  DenseFlowConfig flow;
  LeastSquaresConfig least_squares{.weighting = Weighting::plain};
  KalmanFilterConfig filter;
  Integration integration = Integration::euler;

  static void fields(auto& self, auto&& field) {
    field("flow", self.flow, "step 2: dense optical flow");
    field("least_squares", self.least_squares, "step 3: least squares for six velocities");
    field("filter", self.filter, "step 4: one Kalman filter per axis");
    field("integration", self.integration, "step 5: integration of velocities to the pose");
  }
};

}  // namespace stillkite
