import numpy as np
import pytest
import stillkite

COUNT = 101
STAMPS_NS = np.arange(COUNT) * 100_000_000
X_M = np.linspace(0, 10, COUNT)
POSITIONS_M = np.column_stack([X_M, np.sin(X_M), np.full(COUNT, 20.0)])
LEVEL = np.tile([1.0, 0, 0, 0], (COUNT, 1))
TRUTH = stillkite.Trajectory(STAMPS_NS, POSITIONS_M, LEVEL)


def test_the_truth_itself_has_no_error():
    result = stillkite.evaluate(TRUTH, TRUTH)
    assert result.matched == COUNT
    assert result.position_rmse_m == result.yaw_rmse_rad == result.drift_percent == 0
    assert result.per_frame.count == COUNT - 1


def test_a_constant_offset_is_the_absolute_error_and_no_relative_one():
    moved = stillkite.Trajectory(STAMPS_NS, POSITIONS_M + [3, 0, 4], LEVEL)
    result = stillkite.evaluate(moved, TRUTH)
    assert result.position_rmse_m == pytest.approx(5)
    assert result.end_error_horizontal_m == pytest.approx(3)
    assert result.end_error_vertical_m == pytest.approx(4)
    assert result.per_frame.translation_rmse_m == pytest.approx(0, abs=1e-12)
    assert stillkite.evaluate(moved, TRUTH, "se3").position_rmse_m == pytest.approx(0, abs=1e-9)


def test_a_scale_error_is_removed_by_a_similarity_alone():
    scaled = stillkite.Trajectory(STAMPS_NS, 1.1 * POSITIONS_M, LEVEL)
    assert stillkite.evaluate(scaled, TRUTH, "se3").position_rmse_m > 0.1
    assert stillkite.evaluate(scaled, TRUTH, "sim3").position_rmse_m == pytest.approx(0, abs=1e-9)
    step = stillkite.relative_error(scaled, TRUTH, frames=1)
    steps_m = np.linalg.norm(np.diff(POSITIONS_M, axis=0), axis=1)
    assert step.translation_rmse_m == pytest.approx(0.1 * np.sqrt(np.mean(steps_m**2)))
    assert step.mean_length_m == pytest.approx(steps_m.mean())
    assert stillkite.relative_error(scaled, TRUTH, distance_m=1000) is None


def test_a_yaw_error_is_measured():
    angle = 0.2
    turned = np.tile([np.cos(angle / 2), 0, 0, np.sin(angle / 2)], (COUNT, 1))
    result = stillkite.evaluate(stillkite.Trajectory(STAMPS_NS, POSITIONS_M, turned), TRUTH)
    assert result.yaw_rmse_rad == pytest.approx(angle)
    assert result.tilt_rmse_rad == pytest.approx(0, abs=1e-7)


def test_positions_alone_have_no_attitude_error():
    positions = stillkite.Trajectory(STAMPS_NS, POSITIONS_M)
    assert positions.attitudes_wxyz is None
    assert stillkite.evaluate(positions, TRUTH).yaw_rmse_rad is None


def test_a_trajectory_returns_its_arrays():
    assert (TRUTH.stamps_ns == STAMPS_NS).all()
    assert (TRUTH.positions_m == POSITIONS_M).all()
    assert (TRUTH.attitudes_wxyz == LEVEL).all()
    assert len(TRUTH) == COUNT


def test_a_trajectory_is_read_from_a_tum_file(tmp_path):
    file = tmp_path / "truth.tum"
    rows = [f"{t * 1e-9:.9f} {x} {y} {z} 0 0 0.6 0.8"
            for t, (x, y, z) in zip(STAMPS_NS, POSITIONS_M)]
    file.write_text("\n".join(rows) + "\n")
    read = stillkite.Trajectory.read(file)
    assert (read.stamps_ns == STAMPS_NS).all()
    assert np.allclose(read.positions_m, POSITIONS_M)
    assert np.allclose(read.attitudes_wxyz, [0.8, 0, 0, 0.6])


@pytest.mark.parametrize("arguments, message", [
    ((STAMPS_NS * 1e-9, POSITIONS_M), "dtype float64; pass integer nanoseconds"),
    ((STAMPS_NS[::-1], POSITIONS_M), "row 1 .* is not after row 0"),
    ((STAMPS_NS, POSITIONS_M[:5]), r"positions_m: shape \(5, 3\); expected \(101, 3\)"),
    ((STAMPS_NS, POSITIONS_M[:, :2]), r"expected \(101, 3\)"),
    ((STAMPS_NS, POSITIONS_M, 2 * LEVEL), "norm 2; pass a unit quaternion"),
])
def test_wrong_arrays_are_errors(arguments, message):
    with pytest.raises(stillkite.InputError, match=message):
        stillkite.Trajectory(*arguments)


def test_trajectories_of_other_times_are_an_error():
    late = stillkite.Trajectory(STAMPS_NS + 10**15, POSITIONS_M)
    with pytest.raises(stillkite.InputError, match="same clock"):
        stillkite.evaluate(late, TRUTH)


def test_estimates_become_a_trajectory(rendered):
    estimates = rendered.estimates()
    trajectory = stillkite.Trajectory.from_estimates(estimates)
    assert (trajectory.positions_m[-1] == estimates[-1].metric.position_in_world_m).all()
    # the range finder has an error of 0.05 m
    assert stillkite.evaluate(trajectory, rendered.flight.truth).position_rmse_m < 0.05


def test_estimates_of_two_units_are_an_error(rendered):
    estimates = rendered.estimates("fused")
    assert estimates[0].metric is None and estimates[-1].metric
    with pytest.raises(stillkite.InputError, match="estimate 0: no position in metres"):
        stillkite.Trajectory.from_estimates(estimates)
    metric = stillkite.Trajectory.from_estimates([e for e in estimates if e.metric])
    assert stillkite.evaluate(metric, rendered.flight.truth).position_rmse_m < 0.05
