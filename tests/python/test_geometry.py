import numpy as np
import pytest
import stillkite

FISHEYE = stillkite.Camera(640, 480, 300, 310, 320, 240, "equidistant", [0.01, -0.02, 0.003, 0])
PINHOLE = stillkite.Camera(640, 480, 300, 310, 320, 240)


def test_a_point_on_the_axis_projects_to_the_principal_point():
    for camera in (PINHOLE, FISHEYE):
        assert np.allclose(camera.project([[0, 0, 2]]), [[320, 240]])


def test_a_pinhole_projects_by_its_focal_lengths():
    pixels = PINHOLE.project([[1, 0, 2], [0, 1, 2], [0, 0, -1]])
    assert pixels[:2].tolist() == [[470, 240], [320, 395]]
    assert np.isnan(pixels[2]).all()


def test_undistort_is_the_inverse_of_project():
    points = np.random.default_rng(1).uniform(-0.8, 0.8, (50, 2))
    pixels = FISHEYE.project(np.column_stack([points, np.ones(50)]))
    assert np.abs(FISHEYE.undistort(pixels) - points).max() < 1e-9


def test_the_number_of_coefficients_must_fit_the_model():
    with pytest.raises(stillkite.InputError, match="coefficients"):
        stillkite.Camera(640, 480, 300, 300, 320, 240, "equidistant", [0.1])
    with pytest.raises(stillkite.InputError, match="must be positive"):
        stillkite.Camera(640, 480, 0, 300, 320, 240)


def test_a_transform_of_a_matrix_and_of_a_quaternion_are_equal():
    quarter_turn = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # about z
    a = stillkite.RigidTransform(quarter_turn, [1, 2, 3])
    b = stillkite.RigidTransform([[0, -1, 0], [1, 0, 0], [0, 0, 1]], [1, 2, 3])
    assert np.allclose(a.matrix, b.matrix)
    assert np.allclose(a.transform([1, 0, 0]), [1, 3, 3])
    assert np.allclose((a @ a.inverse()).matrix, np.eye(4))
    assert np.allclose(a.rotation_wxyz, quarter_turn)
    assert (stillkite.RigidTransform().matrix == np.eye(4)).all()


@pytest.mark.parametrize("rotation", [
    [1, 1, 0, 0], np.zeros((3, 3)), -np.eye(3), np.diag([1, 1, 1.1]), np.eye(4), [np.nan, 0, 0, 1]])
def test_another_rotation_is_an_error(rotation):
    with pytest.raises(stillkite.InputError):
        stillkite.RigidTransform(rotation)


def test_the_mount_looks_down_by_its_angle():
    assert np.allclose(stillkite.mount().transform([0, 0, 1]), [0, 0, -1])
    assert np.allclose(stillkite.mount(0, [1, 0, 0]).transform([0, 0, 1]), [2, 0, 0])


def test_a_calibration_is_read(tmp_path):
    file = tmp_path / "sensor.yaml"
    file.write_text("sensor_type: camera\nresolution: [640, 480]\nintrinsics: [300, 310, 320, 240]\n"
                    "camera_model: pinhole\ndistortion_model: radial-tangential\n"
                    "distortion_coefficients: [0.1, 0, 0, 0]\n")
    calibration = stillkite.read_calibration(file)
    assert calibration.camera == stillkite.Camera(
        640, 480, 300, 310, 320, 240, "radial-tangential", [0.1, 0, 0, 0])
    assert calibration.body_from_camera is None
