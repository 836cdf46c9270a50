import os
import pathlib
import subprocess
import sys

import pytest

EXAMPLE = pathlib.Path(__file__).parents[2] / "examples/frames_to_plot.py"


def test_the_example_plots_a_position_error_of_millimetres(tmp_path):
    pytest.importorskip("matplotlib", reason="run scripts/install-dependencies python")
    run = subprocess.run([sys.executable, EXAMPLE], cwd=tmp_path, stdout=subprocess.PIPE, text=True,
                         env={**os.environ, "MPLBACKEND": "Agg"}, check=True)
    assert 0 < float(run.stdout.split()[1]) < 20
    assert (tmp_path / "position_error.png").read_bytes().startswith(b"\x89PNG")


def test_the_example_has_at_most_20_lines():
    assert len(EXAMPLE.read_text().splitlines()) <= 20
