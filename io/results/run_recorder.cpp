#include "io/results/run_recorder.hpp"

#include "io/dataset/trajectory_file.hpp"
#include "io/results/estimates_csv.hpp"

namespace stillkite {

RunRecorder::RunRecorder(const std::filesystem::path& folder)
    : table_(folder / "estimates.csv"), trajectory_(folder / "trajectory.tum") {
  table_.write(estimates_csv_header());
  trajectory_.write(kTumHeader);
}

void RunRecorder::add(const NavigationEstimate& estimate) {
  table_.write(estimates_csv_row(estimate));
  trajectory_.write(tum_line({estimate.stamp, estimate.world_from_body}));
}

void RunRecorder::finish() {
  table_.finish();
  trajectory_.finish();
}

void RunRecorder::commit() {
  table_.commit();
  trajectory_.commit();
}

}  // namespace stillkite
