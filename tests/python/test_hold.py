import numpy as np
import pytest
import stillkite

LEVEL = [1, 0, 0, 0]
NOW_NS = 1_000_000_000


def tether():
    return stillkite.TetherReading(NOW_NS, 10, np.pi / 2, 0)


def motion(displacement_m):
    # the camera's axes are those of the station
    return stillkite.MotionEstimate(NOW_NS, LEVEL, "metric", displacement_m, 1e-6 * np.eye(3),
                                    scale="range")


def test_without_an_estimate_the_controller_holds():
    decision = stillkite.HoldController().decide(NOW_NS, None, tether(), LEVEL)
    assert (decision.action, decision.reason) == ("hold", "no_estimate")
    assert decision.command.length_rate_m_s == 0


def test_a_drone_that_is_too_high_is_reeled_in():
    decision = stillkite.HoldController(shadow=True).decide(NOW_NS, motion([0, 0, 0.3]), tether(), LEVEL)
    assert decision.action == "command"
    assert decision.command.length_rate_m_s < -0.05
    assert decision.position_error_in_station_m.tolist() == pytest.approx([0, 0, -0.3])
    opposite = stillkite.HoldController(shadow=True).decide(NOW_NS, motion([0, 0, -0.3]), tether(), LEVEL)
    assert opposite.command.length_rate_m_s == pytest.approx(-decision.command.length_rate_m_s)


def test_limits_are_those_of_the_configuration():
    config = {"hold": {"limits": {"length_rate_m_s": 0.01}}}
    decision = stillkite.HoldController(config, shadow=True).decide(
        NOW_NS, motion([0, 0, 0.3]), tether(), LEVEL)
    assert decision.command.length_rate_m_s == pytest.approx(-0.01)


def test_an_operator_withholds_the_command():
    decision = stillkite.HoldController().decide(NOW_NS, motion([0, 0, 1]), tether(), LEVEL, "stopped")
    assert (decision.action, decision.reason) == ("hold", "stopped")


def test_limits_that_contradict_each_other_are_an_error():
    with pytest.raises(stillkite.InputError):
        stillkite.HoldController({"hold": {"limits": {"min_length_m": 9, "max_length_m": 8}}})


def test_the_pilot_estimates_and_commands(rendered):
    flight = rendered.flight
    pilot = stillkite.HoverPilot(flight.camera, flight.body_from_camera, flight.initial, shadow=True)
    navigator = rendered.navigator()
    for i in range(4):
        reading = stillkite.TetherReading(rendered.stamps_ns[i], 15, np.pi / 3, 0)
        step = pilot.step(rendered.images[i], rendered.stamps_ns[i], reading)
        estimate = navigator.step(rendered.images[i], rendered.stamps_ns[i])
        assert (step.estimate.metric.position_in_world_m
                == estimate.metric.position_in_world_m).all()
    assert step.decision.action == "command"
    positions_m = flight.truth.positions_m
    error_m = step.decision.position_error_in_station_m
    assert error_m == pytest.approx(positions_m[0] - positions_m[3], abs=0.02)
