#!/bin/sh
# Exit status and output of `check`: 2 if something is wrong; with --json the findings alone on stdout.
# usage: check_status_test.sh STILLKITE SIMULATED_FLIGHT OUT
stillkite=$1 flight=$2 out=$3
mkdir -p "$out"
fail() { echo "$1"; cat "$out/stdout" "$out/stderr"; exit 1; }
expect() {  # STATUS PATTERN ARGUMENTS...
  status=$1 pattern=$2
  shift 2
  "$stillkite" check "$@" > "$out/stdout" 2> "$out/stderr"
  actual=$?
  [ $actual -eq "$status" ] || fail "exit status $actual, expected $status"
  grep -q "$pattern" "$out/stdout" || fail "no '$pattern'"
}
expect 0 "^ok .* resolution  *images 640x480, calibration 640x480" "$flight/run.yaml"
expect 0 '^  "verdict": "ok"' "$flight/run.yaml" --json
expect 2 "^wrong .* resolution" "$flight/run.yaml" --set calibration.path= --set calibration.camera={}
expect 2 "^wrong  *images .*no such file" "$flight/run.yaml" --set source.path=none.mp4
expect 2 "^wrong  *imu log .*no such file" "$flight/run.yaml" --set imu.path=none.csv
grep -q "^ok .* resolution" "$out/stdout" || fail "an invalid log prevents the other questions"
exit 0
