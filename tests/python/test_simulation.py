import pathlib

import numpy as np
import pytest
import stillkite

FLIGHT = pathlib.Path(__file__).parent / "flight.yaml"


def test_a_flight_has_an_image_for_each_stamp(rendered):
    flight = rendered.flight
    assert len(flight) == len(flight.stamps_ns) == len(flight.truth) == 51
    assert (np.diff(flight.stamps_ns) == 40_000_000).all()
    image = flight.image(0)
    assert (image.shape, image.dtype) == ((480, 640), np.uint8)
    assert image.std() > 5
    assert not image.flags.owndata  # the pixels of the renderer


def test_images_are_reproducible_in_any_order(rendered):
    assert (rendered.flight.image(50) == rendered.images[50]).all()
    assert (rendered.flight.image(-1) == rendered.images[50]).all()
    assert (stillkite.SimulatedFlight(FLIGHT).image(3) == rendered.images[3]).all()
    other = stillkite.SimulatedFlight(FLIGHT, ["seed=2"])
    assert (other.image(3) != rendered.images[3]).mean() > 0.5
    with pytest.raises(IndexError):
        rendered.flight.image(51)


def test_velocities_are_the_derivative_of_the_positions(rendered):
    positions_m = rendered.flight.truth.positions_m
    differences_m_s = (positions_m[2:] - positions_m[:-2]) / 0.08
    errors = differences_m_s - rendered.flight.velocities_in_world_m_s[1:-1]
    assert np.abs(errors).max() < 0.01


def test_readings_of_an_interval_cover_it(rendered):
    readings = rendered.readings[10]
    assert readings.imu_stamps_ns[-1] == rendered.stamps_ns[10]
    assert len(readings.imu_stamps_ns) == 8  # 200 Hz, 25 images/s
    force_m_s2 = readings.imu[:, 3:].mean(axis=0)
    assert np.linalg.norm(force_m_s2) == pytest.approx(9.81, abs=0.5)
    assert readings.height_m == pytest.approx(rendered.flight.truth.positions_m[10, 2], abs=0.3)


def test_a_log_of_arrays_gives_the_readings_of_its_interval():
    stamps_ns = np.arange(0, 10) * 10_000_000
    imu = np.arange(60, dtype=float).reshape(10, 6)
    log = stillkite.SensorLog(imu_stamps_ns=stamps_ns, imu=imu, height_stamps_ns=stamps_ns,
                              height_m=np.linspace(5, 14, 10))
    readings = log.between(20_000_000, 50_000_000)
    assert readings.imu_stamps_ns.tolist() == [30_000_000, 40_000_000, 50_000_000]
    assert (readings.imu == (imu[2:5] + imu[3:6]) / 2).all()
    assert readings.height_m == pytest.approx(10)


@pytest.mark.parametrize("arguments, message", [
    ({"imu": np.zeros((3, 6))}, "imu_stamps_ns and imu: pass both"),
    ({"imu": np.zeros((3, 5)), "imu_stamps_ns": np.arange(3)}, r"imu: shape \(3, 5\); expected \(3, 6\)"),
    ({"imu": np.zeros((3, 6)), "imu_stamps_ns": np.arange(3) / 10}, "pass integer nanoseconds"),
])
def test_wrong_readings_are_errors(arguments, message):
    for kind in (stillkite.SensorLog, stillkite.SensorReadings):
        with pytest.raises(stillkite.InputError, match=message):
            kind(**arguments)


def test_a_photograph_is_the_ground():
    dark = stillkite.SimulatedFlight(FLIGHT, ["camera.noise_grey=0"],
                                     photograph=np.full((64, 64), 40, np.uint8))
    image = dark.image(0)
    assert image.min() == image.max()
    with pytest.raises(stillkite.InputError, match="pass its grey levels as photograph"):
        stillkite.SimulatedFlight(FLIGHT, ["ground.photograph=ground.png"])


def test_an_unknown_key_is_an_error():
    with pytest.raises(stillkite.InputError, match="hight_m"):
        stillkite.SimulatedFlight({"flight": {"hight_m": 3}})
