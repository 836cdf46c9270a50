import pathlib

import numpy as np
import pytest
import stillkite


def test_text_dict_file_and_overrides_give_the_same_configuration(tmp_path):
    text = "estimator: {policy: fused}\nnavigator: {readout_s: 0.016}\n"
    file = tmp_path / "run.yaml"
    file.write_text(text)
    values = {"estimator": {"policy": "fused"}, "navigator": {"readout_s": np.float64(0.016)}}
    overrides = ["estimator.policy=fused", "navigator.readout_s=0.016"]
    configs = [stillkite.Config(text), stillkite.Config(values), stillkite.Config(file),
               stillkite.Config(overrides=overrides)]
    assert {config.policy for config in configs} == {"fused"}
    assert len({str(config) for config in configs}) == 1
    assert str(stillkite.Config(str(configs[0]))) == str(configs[0])


def test_values_of_a_dict_keep_type_and_value(tmp_path):
    config = str(stillkite.Config({
        "source": {"path": tmp_path / "a.mp4"},
        "mount": {"position_m": np.array([0.1, 1e-9, 2])},
        "navigator": {"keyframes": {"enabled": False, "give_up_after": np.int64(7)}},
        "imu": {"path": None}}))
    assert "position_m: [0.1, 1e-09, 2]" in config
    assert "enabled: false" in config
    assert "give_up_after: 7" in config
    assert f"path: {tmp_path / 'a.mp4'}" in config


@pytest.mark.parametrize("source, message", [
    ({"estimator": {"polcy": "flow"}}, "polcy"),
    ({"estimator": {"policy": "best of all"}}, "not one of flow, reference, best, fused"),
    ({"navigator": {"trust": {"min_windows": 0}}}, r"min_windows: 0 is out of range.*\[1, 100000\]"),
    ({"navigator": {"readout_s": "0.01"}}, "readout_s"),
    ({"navigator": {"readout_s": float("nan")}}, "readout_s"),
    ("estimator: [", "configuration:1:1: invalid YAML"),
    (pathlib.Path("no_such.yaml"), "no_such.yaml"),
])
def test_a_wrong_configuration_is_an_error_that_names_the_key(source, message):
    with pytest.raises(stillkite.InputError, match=message):
        stillkite.Config(source)


@pytest.mark.parametrize("source", [3, ["estimator"], {"estimator": {"policy": object()}}])
def test_another_type_is_a_type_error(source):
    with pytest.raises(TypeError):
        stillkite.Config(source)


def test_a_renamed_key_is_a_warning():
    with pytest.warns(DeprecationWarning, match="is now 'reference.gate.max_consecutive_rejections'"):
        config = stillkite.Config({"reference": {"gate": {"strikes": 5}}})
    assert "max_consecutive_rejections: 5" in str(config)
