#!/usr/bin/env python3
"""Frame rate of `stillkite run` on a video, compared with decoding alone by OpenCV.

Alternates the two, so that other load of the machine affects both, and prints medians: frames/s, CPU
time per frame, peak memory. Goal: at least 0.9 of OpenCV's rate, or CPU time at most OpenCV's + 4 ms
per frame. Exit status 1 if neither is met.

  bench/run_rate.py flight/run.yaml flight/flight.mp4
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/release"


def timed(arguments):
    """(wall s, CPU s, peak MiB, standard output) of a command; exits if it fails."""
    start = time.monotonic()
    child = subprocess.Popen([str(a) for a in arguments], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True)
    output = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall_s = time.monotonic() - start
    if status != 0:
        sys.exit(f"run_rate: {arguments[0]} failed; run it by hand: {' '.join(map(str, arguments))}")
    return wall_s, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, output


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("config", help="configuration for `stillkite run`")
    parser.add_argument("video", help="video named in it")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each (default: 3)")
    options = parser.parse_args()
    runs = {"OpenCV decodes": [], "stillkite run": []}
    frames = 0
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(options.repeat):
            decoded = timed([BUILD / "bench/bench_opencv_decoding", options.video])
            frames = int(decoded[3])
            runs["OpenCV decodes"].append(decoded)
            runs["stillkite run"].append(timed([BUILD / "app/stillkite", "run", options.config,
                                                "--set", "output.overlay=false", "--out", folder + "/run"]))
    rate, cpu_ms = {}, {}
    print(f"{frames} frames, medians of {options.repeat}\n{'':18}{'frames/s':>10}{'CPU ms/frame':>14}{'peak MiB':>10}")
    for name, results in runs.items():
        wall_s, cpu_s, peak_mib = (statistics.median(r[i] for r in results) for i in range(3))
        rate[name], cpu_ms[name] = frames / wall_s, 1000 * cpu_s / frames
        print(f"{name:18}{rate[name]:10.1f}{cpu_ms[name]:14.2f}{peak_mib:10.0f}")
    ratio = rate["stillkite run"] / rate["OpenCV decodes"]
    extra_ms = cpu_ms["stillkite run"] - cpu_ms["OpenCV decodes"]
    print(f"rate {ratio:.2f} of OpenCV's (goal 0.9), CPU time {extra_ms:+.2f} ms per frame (goal +4)")
    sys.exit(0 if ratio >= 0.9 or extra_ms <= 4 else 1)


if __name__ == "__main__":
    main()
