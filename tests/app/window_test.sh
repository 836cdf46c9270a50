#!/bin/sh
# Policy fused by the sliding window in a simulated room, with right and wrong IMU logs.
# usage: window_test.sh STILLKITE CONFIGS OUT
stillkite=$1 configs=$2 out=$3
rm -rf "$out"
"$stillkite" simulate "$configs/simulate_room.yaml" --set flight.duration_s=6 --set flight.rest_s=1 \
  --set "camera.lever_arm_m=[0,0,0]" --out "$out/flight" 2>/dev/null || exit 1
log=$out/flight/imu0/data.csv

# run NAME LOG: summary and messages in $out/NAME.json and .err
run() {
  "$stillkite" run "$out/flight/run.yaml" --set fusion.solver=window --set imu.path="$2" \
    --out "$out/$1" --json > "$out/$1.json" 2> "$out/$1.err" || { cat "$out/$1.err"; exit 1; }
}
# position_below NAME LIMIT_M
position_below() {
  awk -v limit="$2" '/"position_rmse_m"/ { sub(/,/, "", $2); print "position_rmse_m", $2; ok = $2 + 0 < limit }
       END { exit !ok }' "$out/$1.json" || { echo "$1: position RMSE above $2 m"; exit 1; }
}
# message NAME TEXT
message() {
  grep -q "$2" "$out/$1.err" || { cat "$out/$1.err"; echo "$1: no message '$2'"; exit 1; }
}

run right "$log"
position_below right 0.01
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^inlier_ratio/) column = i }
        END { exit !($column > 0.5) }' "$out/right/estimates.csv" ||
  { echo "right: fewer than half of the points are inliers"; exit 1; }
if grep "imu\|mount" "$out/right.err"; then echo "right: a message accuses a right sensor"; exit 1; fi

"$stillkite" run "$out/flight/run.yaml" --set imu.path="$log" --set initial.from_truth=false \
  --set source.end_s=1 --out "$out/filter" 2> "$out/filter.err" > "$out/filter.txt" ||
  { cat "$out/filter.err"; exit 1; }
message filter "can diverge without a height"

awk -F, -v OFS=, 'NR > 1 { $1 = sprintf("%.0f", $1 + 4e7) } 1' "$log" > "$out/late.csv"
run late "$out/late.csv"
position_below late 0.02
message late "clock is +\(39\|40\)\.[0-9] ms"

awk -F, -v OFS=, 'NR > 1 { x = $5; $5 = $6; $6 = x } 1' "$log" > "$out/axes.csv"
run axes "$out/axes.csv"
message axes "accelerometer bias"
tail -n 1 "$out/axes/estimates.csv" | grep -q ",lost" ||
  { echo "axes: the last frame is not lost"; exit 1; }

# From rest, without an initialization in motion.
rotate_about_z() {
  awk -F, -v OFS=, 'NR > 1 { x = $2; $2 = -$3; $3 = x; x = $5; $5 = -$6; $6 = x } 1' "$log"
}
rotate_about_z > "$out/rotated.csv"
run rotated "$out/rotated.csv"
message rotated "gyroscope axes rotated by 9"
tail -n 1 "$out/rotated/estimates.csv" | grep -q ",lost" ||
  { echo "rotated: the last frame is not lost"; exit 1; }
