import os
import pathlib
import subprocess
import threading

import numpy as np
import pytest
import stillkite

FLIGHT = pathlib.Path(__file__).parent / "flight.yaml"


def attribute(estimate, path):
    for name in path.split("."):
        estimate = getattr(estimate, name)
    return estimate


def reference_lines(policy):
    program = os.environ["NAVIGATOR_REFERENCE"]
    run = subprocess.run([program, FLIGHT, policy], input="estimates\n", text=True,
                         stdout=subprocess.PIPE, check=True)
    return run.stdout.splitlines()


@pytest.mark.parametrize("policy", ["flow", "reference", "best", "fused"])
def test_estimates_equal_those_of_cpp_bit_for_bit(rendered, policy):
    estimates = rendered.estimates(policy)
    lines = reference_lines(policy)
    assert len(lines) == len(estimates) == 51
    for line, estimate in zip(lines, estimates):
        stamp_ns, verdict, source, *values = line.split()
        assert (int(stamp_ns), verdict, source) == (
            estimate.stamp_ns, estimate.verdict, estimate.source)
        groups = {name.split(".")[0] for name in (v.split("=")[0] for v in values) if "." in name}
        for group in ("metric", "relative", "reference"):
            assert (getattr(estimate, group) is not None) == (group in groups)
        for name, text in (value.split("=") for value in values):
            expected = [float.fromhex(number) for number in text.strip(",").split(",")]
            assert attribute(estimate, name).ravel().tolist() == expected, name


def test_metric_position_is_that_of_the_truth(rendered):
    navigator = rendered.navigator()
    estimates = [navigator.step(*inputs) for inputs in zip(rendered.images, rendered.stamps_ns)]
    error_m = estimates[-1].metric.position_in_world_m - rendered.flight.truth.positions_m[-1]
    assert np.linalg.norm(error_m) < 0.01  # of 6 m
    assert estimates[0].verdict == "first_frame"
    assert {e.verdict for e in estimates[1:]} == {"ok"}
    assert all(e.is_measured for e in estimates)


def test_rows_may_be_part_of_a_larger_image(rendered):
    height, width = rendered.images[0].shape
    views = [np.full((height + 4, width + 6), 255, np.uint8)[2:-2, 3:-3] for _ in range(2)]
    contiguous, cropped = rendered.navigator(), rendered.navigator()
    for i, view in enumerate(views):
        view[:] = rendered.images[i]
        view.flags.writeable = False
        a = contiguous.step(rendered.images[i], rendered.stamps_ns[i])
        b = cropped.step(view, rendered.stamps_ns[i])
        assert (a.metric.position_in_world_m == b.metric.position_in_world_m).all()


def test_an_image_may_change_after_the_step(rendered):
    kept, reused = rendered.navigator(), rendered.navigator()
    buffer = np.empty_like(rendered.images[0])
    for image, stamp_ns in zip(rendered.images[:5], rendered.stamps_ns):
        buffer[:] = image
        a, b = kept.step(image, stamp_ns), reused.step(buffer, stamp_ns)
        buffer[:] = 0
    assert (a.metric.position_in_world_m == b.metric.position_in_world_m).all()


@pytest.mark.parametrize("change, message", [
    (lambda image: image.astype(float), "dtype float64; pass grey levels"),
    (lambda image: image.astype(bool), "dtype bool"),
    (lambda image: image.view(np.int8), "dtype int8"),
    (lambda image: np.dstack([image] * 3), r"shape \(480, 640, 3\); pass one grey channel"),
    (lambda image: image.ravel(), r"shape \(307200\)"),
    (lambda image: image.T, "pixels of a row are 640 bytes apart; pass numpy.ascontiguousarray"),
    (lambda image: image[:, ::2], "pixels of a row are 2 bytes apart"),
    (lambda image: image[::-1], "rows of 640 pixels are -640 bytes apart"),
    (lambda image: image[:-1], "640x479 pixels; the camera needs 640x480"),
    (lambda image: image[:0], "640x0 pixels"),
])
def test_a_wrong_array_is_an_error_with_its_remedy(rendered, change, message):
    navigator = rendered.navigator()
    with pytest.raises(stillkite.InputError, match=message) as raised:
        navigator.step(change(rendered.images[0]), 0)
    assert isinstance(raised.value, ValueError)
    # the navigator can be used on
    assert navigator.step(rendered.images[0], 0).verdict == "first_frame"


def test_a_list_is_no_image(rendered):
    with pytest.raises(TypeError):
        rendered.navigator().step([[1, 2]], 0)


def test_the_mask_must_have_the_size_of_the_camera(rendered):
    with pytest.raises(stillkite.InputError, match="image mask: 3x2 pixels; the camera needs"):
        rendered.navigator(valid_pixels=np.ones((2, 3), np.uint8))


def test_the_initial_camera_must_be_above_the_ground(rendered):
    below = stillkite.InitialState(stillkite.RigidTransform(translation=[0, 0, -1]))
    with pytest.raises(stillkite.InputError, match="must be above the ground"):
        stillkite.Navigator(rendered.flight.camera, rendered.flight.body_from_camera, below)


def test_arrays_of_an_estimate_are_read_only_views(rendered):
    navigator = rendered.navigator()
    estimate = navigator.step(rendered.images[0], 0, rendered.readings[0])
    position_m = estimate.metric.position_in_world_m
    covariance_m2 = estimate.metric.position_covariance_m2
    for array in (position_m, covariance_m2, estimate.attitude_covariance_rad2):
        assert not array.flags.owndata
        assert not array.flags.writeable
    height_m = position_m[2]
    # a view keeps the estimate alive
    del estimate, navigator
    np.full(10000, 7.0)
    assert position_m[2] == height_m > 19


def test_other_threads_run_during_a_step(rendered):
    count, running = 0, True

    def work():
        nonlocal count
        while running:
            count += 1

    thread = threading.Thread(target=work)
    thread.start()
    navigator, progressed = rendered.navigator("fused"), 0
    for inputs in zip(rendered.images, rendered.stamps_ns, rendered.readings):
        before = count
        navigator.step(*inputs)
        progressed += count > before
    running = False
    thread.join()
    assert progressed > 0.8 * len(rendered.images)


def test_steps_of_two_threads_wait_for_each_other(rendered):
    navigator, indices = rendered.navigator(), []

    def work():
        for i in range(10):
            indices.append(navigator.step(rendered.images[i], rendered.stamps_ns[i]).frame_index)

    threads = [threading.Thread(target=work) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(indices) == list(range(20))
