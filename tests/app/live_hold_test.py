#!/usr/bin/env python3
"""Closed loop through the wires: `stillkite fly` holds the drone of `stillkite hover --serve`, engaged
on the operator's page, the record reproduces estimates and commands, and `kill -9` of `fly` sets zero
rates.

usage: live_hold_test.py STILLKITE OUT
"""

import importlib.util
import json
import pathlib
import shutil
import sys
import time
import urllib.request

stillkite, out = sys.argv[1], pathlib.Path(sys.argv[2])
bench = pathlib.Path(__file__).resolve().parent.parent.parent / "bench/live_hold.py"
spec = importlib.util.spec_from_file_location("live_hold", bench)
live_hold = importlib.util.module_from_spec(spec)
spec.loader.exec_module(live_hold)

shutil.rmtree(out, ignore_errors=True)
out.mkdir(parents=True)


def trial(name, port, reach_m):
    folder = out / name
    folder.mkdir()
    further = ["--set", f"plant.station.level_reach_m={reach_m}", "--set", f"serve.video_port={port}",
               "--set", f"serve.mavlink_port={port + 1}"]
    return live_hold.Flight(stillkite, live_hold.hover_arguments("x", "fused", further), folder,
                            ["--set", f"live.listen=127.0.0.1:{port + 2}"])


def page(port, path, body=None):
    """Answer of the operator's page to GET, or to POST with a body."""
    request = urllib.request.Request(f"http://127.0.0.1:{port + 2}{path}", data=body,
                                     headers={"X-Operator": 32 * "0"})
    with urllib.request.urlopen(request, timeout=5) as answer:
        return answer.read()


# The station moves by 0.5 m: without control the mean displacement is 0.25 m.
held = trial("held", 38641, 0.5)
page(38641, "/take_control", b"")
page(38641, "/command", b'{"command": "engage"}')
time.sleep(1)
assert json.loads(page(38641, "/state"))["flight"]["control"]["engaged"], held.messages.read_text()
assert page(38641, "/image").startswith(b"\xff\xd8"), "no JPEG"
mean_m = held.finish()["trials"][0]["mean_m"]
assert mean_m < 0.1, f"mean displacement {mean_m} m\n{held.messages.read_text()}"
assert live_hold.is_reproduced(stillkite, held.record, out / "again"), "the record differs"
assert len(live_hold.compared(held.record / "commands.csv")) > 200

killed = trial("killed", 38645, 0.5)
killed.command("engage")
time.sleep(3)
killed.flight.kill()
killed.finish()
reasons = [row.split(",")[2] for row in live_hold.rows(killed.record / "commands.csv")]
assert reasons[-1] == "estimator_ended", reasons[-5:]
assert "none" in reasons, "nothing was commanded"
rates = [row.split(",")[-4:] for row in live_hold.rows(killed.drone / "samples.csv")]
is_zero = [all(float(rate) == 0 for rate in row) for row in rates]
assert not all(is_zero[:60]) and all(is_zero[150:]), "the rates are not zero after kill -9"
