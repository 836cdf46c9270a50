#!/usr/bin/python3
"""Processor time of Navigator.step from Python relative to C++, over the same rendered flight.

  bench/python_step.py [--passes 15] [POLICY...]

Both programs keep the images in memory and alternate: each pass is a flight by a new navigator. The
time of a step is its minimum over the passes, against other load; the times are means over the
images. Needs the targets stillkite_python and
navigator_reference.
"""

import argparse
import pathlib
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "build/release/python"))
import stillkite  # noqa: E402

REFERENCE = ROOT / "build/release/tests/python/navigator_reference"
FLIGHT = ROOT / "tests/python/flight.yaml"
LIMIT = 1.03


class PythonFlight:
    def __init__(self, policy):
        self.flight = stillkite.SimulatedFlight(FLIGHT)
        self.config = stillkite.Config({"estimator": {"policy": policy}})
        log, stamps_ns = self.flight.sensors(), self.flight.stamps_ns
        self.inputs = [
            (self.flight.image(i), stamps_ns[i], log.between(stamps_ns[max(0, i - 1)], stamps_ns[i]))
            for i in range(len(self.flight))]

    def pass_ns(self):
        flight, times_ns = self.flight, []
        navigator = stillkite.Navigator(
            flight.camera, flight.body_from_camera, flight.initial, self.config)
        for image, stamp_ns, readings in self.inputs:
            start_ns = time.process_time_ns()
            navigator.step(image, stamp_ns, readings)
            times_ns.append(time.process_time_ns() - start_ns)
        return times_ns


class CppFlight:
    def __init__(self, policy):
        self.program = subprocess.Popen([REFERENCE, FLIGHT, policy], text=True, bufsize=1,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def pass_ns(self):
        self.program.stdin.write("times\n")
        return [int(time_ns) for time_ns in self.program.stdout.readline().split()]

    def close(self):
        self.program.stdin.close()
        self.program.wait()


def compare(policy, passes):
    """Mean time of a step by C++ and Python, ms."""
    flights = [CppFlight(policy), PythonFlight(policy)]
    times_ns = {flight: [] for flight in flights}
    for i in range(passes):
        for flight in flights if i % 2 else reversed(flights):
            times_ns[flight].append(flight.pass_ns())
    flights[0].close()
    return [statistics.mean(map(min, zip(*times_ns[flight]))) * 1e-6 for flight in flights]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policies", nargs="*", metavar="POLICY",
                        default=["flow", "reference", "best", "fused"])
    parser.add_argument("--passes", type=int, default=15)
    arguments = parser.parse_args()
    print(f"{'policy':10} {'C++, ms':>8} {'Python, ms':>11} {'ratio':>6}")
    slow = False
    for policy in arguments.policies:
        cpp_ms, python_ms = compare(policy, arguments.passes)
        ratio = python_ms / cpp_ms
        print(f"{policy:10} {cpp_ms:8.3f} {python_ms:11.3f} {ratio:6.3f}", flush=True)
        slow = slow or ratio > LIMIT
    return int(slow)


if __name__ == "__main__":
    raise SystemExit(main())
