#!/usr/bin/env python3
"""Position hold through the wires of a live flight, compared with the same trial in simulation.

`stillkite hover --serve` simulates the drone in real time; `stillkite fly` holds it by video, IMU
and ground station. Prints the mean displacement of both and their ratio, the latency, the images
that were dropped, and whether `stillkite run` reproduces the record. Exit status 1 if it does not.

The estimator of the live flight is initialized before the station moves, that of `hover` while it
moves: the figures after the first 3 s are comparable.

  bench/live_hold.py                               # axis x, policy fused
  bench/live_hold.py --axis y --policy flow
  bench/live_hold.py -- --set serve.jitter_s=0.015 # further arguments of hover
"""

import argparse
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def wait_for(condition, what, timeout_s=60):
    end = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > end:
            raise TimeoutError(f"{what} is missing after {timeout_s} s")
        time.sleep(0.05)


def rows(file):
    return [line for line in file.read_text().splitlines() if not line.startswith("#")]


def hover_arguments(axis, policy, further):
    return [ROOT / "configs/trials_fused.yaml", "--set", f"estimator.policy={policy}", "--set", "trials.on=1",
            "--set", "trials.off=0", "--set", f"serve.axis={axis}", *further]


class Flight:
    """Simulated drone and `stillkite fly` in a folder; `fly`: its further arguments."""

    def __init__(self, stillkite, hover, folder, fly=()):
        self.drone, self.record, self.messages = folder / "drone", folder / "flight", folder / "messages"
        self.simulation = subprocess.Popen([stillkite, "hover", *hover, "--serve", self.drone],
                                           stdout=subprocess.DEVNULL)
        wait_for((self.drone / "flight.yaml").exists, "the simulated drone")
        with open(self.messages, "w") as messages:
            self.flight = subprocess.Popen([stillkite, "fly", self.drone / "flight.yaml", "--out", self.record, *fly],
                                           stdout=subprocess.DEVNULL, stderr=messages)
        estimates = self.record / "estimates.csv"
        wait_for(lambda: estimates.exists() and len(rows(estimates)) > 60, "an estimate")

    def command(self, command):
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            sender.sendto(json.dumps({"command": command}).encode(), str(self.drone / "operator"))

    def finish(self):
        """Waits for the end of the trial; its summary."""
        self.simulation.wait()
        self.flight.send_signal(signal.SIGINT)
        self.flight.wait()
        if self.simulation.returncode != 0:
            raise RuntimeError("the simulated drone has failed:\n" + self.messages.read_text())
        return json.loads((self.drone / "summary.json").read_text())


def compared(file):
    """Rows without the times of the stages, and without those of the supervising process."""
    lines = rows(file)
    if file.name == "estimates.csv":
        return [line.rsplit(",", 4)[0] for line in lines]
    return [line for line in lines if line.split(",")[2] not in ("estimator_silent", "estimator_ended")]


def is_reproduced(stillkite, record, again):
    subprocess.run([stillkite, "run", record, "--out", again], check=True, stdout=subprocess.DEVNULL)
    return all(compared(record / name) == compared(again / name) for name in ("estimates.csv", "commands.csv"))


def mean_m(samples, trial, axis, after_s):
    """Mean displacement along a paper axis, whose y is up."""
    column = {"x": 2, "y": 4, "z": 3}[axis]
    values = [abs(float(cells[column])) for cells in (row.split(",") for row in rows(samples))
              if int(cells[0]) == trial and float(cells[1]) >= after_s]
    return sum(values) / len(values)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stillkite", default=ROOT / "build/release/app/stillkite")
    parser.add_argument("--axis", default="x", choices="xyz")
    parser.add_argument("--policy", default="fused")
    parser.add_argument("--keep", type=pathlib.Path, help="new folder for the results (default: temporary)")
    parser.add_argument("hover", nargs="*", help="further arguments of stillkite hover")
    arguments = parser.parse_args()
    hover = hover_arguments(arguments.axis, arguments.policy, arguments.hover)
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        flight = Flight(arguments.stillkite, hover, folder)
        flight.command("engage")
        wires = flight.finish()["trials"][0]
        messages = flight.messages.read_text()
        reproduced = is_reproduced(arguments.stillkite, flight.record, folder / "again")
        simulated = json.loads(subprocess.run(
            [arguments.stillkite, "hover", *hover, "--json", "--out", folder / "hover"],
            check=True, capture_output=True, text=True).stdout)
        direct = next(trial for trial in simulated["trials"] if trial["axis"] == arguments.axis)
        index = simulated["trials"].index(direct)
        for name, trial, samples, number in (("through the wires", wires, flight.drone / "samples.csv", 0),
                                             ("hover", direct, folder / "hover/samples.csv", index)):
            trial["after_3_s_m"] = mean_m(samples, number, arguments.axis, 3)
            print(f"{name:<18} mean {100 * trial['mean_m']:.2f} cm, after 3 s {100 * trial['after_3_s_m']:.2f} cm, "
                  f"maximum {100 * trial['max_m']:.2f} cm")
    print(f"ratio of the means {wires['mean_m'] / direct['mean_m']:.2f}, "
          f"after 3 s {wires['after_3_s_m'] / direct['after_3_s_m']:.2f}")
    for line in messages.splitlines():
        if re.search("images decoded|arrival to estimate|lines read", line):
            print(line.removeprefix("stillkite: "))
    print("record reproduced  " + ("bit for bit" if reproduced else "NO"))
    sys.exit(0 if reproduced else 1)


if __name__ == "__main__":
    main()
