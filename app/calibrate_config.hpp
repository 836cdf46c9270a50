#pragma once

#include <optional>

#include "calibration/board_config.hpp"
#include "io/config/run_config.hpp"

namespace stillkite {

/// Configuration of `stillkite calibrate`: that of a run, and the board.
struct CalibrateConfig {
  RunConfig run;
  std::optional<BoardConfig> calibration_board;

  static void fields(auto& self, auto&& field) {
    RunConfig::fields(self.run, field);
    field("calibration_board", self.calibration_board,
          "board in the images: its views determine the lens");
  }
};

}  // namespace stillkite
