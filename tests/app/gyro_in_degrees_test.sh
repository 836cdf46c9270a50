#!/bin/sh
# A gyroscope log in deg/s is reported; the log in rad/s is not.
# usage: gyro_in_degrees_test.sh STILLKITE SIMULATION OUT
stillkite=$1 simulation=$2 out=$3
rm -rf "$out"
"$stillkite" simulate "$simulation" --set flight.duration_s=3 --set flight.yaw_sway_deg=6 \
  --set camera.width_px=480 --set camera.height_px=270 --set camera.focal_x_px=300 \
  --set camera.focal_y_px=300 --set camera.centre_x_px=239.5 --set camera.centre_y_px=134.5 \
  --out "$out/flight" > /dev/null || exit 1
imu=$out/flight/imu0/data.csv
awk -F, -v OFS=, 'NR > 1 { for (i = 2; i <= 4; ++i) $i *= 180 / 3.14159265 } 1' "$imu" > "$out/degrees.csv"
for policy in flow fused; do
  for log in "$imu" "$out/degrees.csv"; do
    "$stillkite" run "$out/flight/run.yaml" --set estimator.policy=$policy --set imu.path="$log" \
      --out "$out/run" 2> "$out/messages" > /dev/null || exit 1
    cat "$out/messages"
    grep -q "deg/s instead of rad/s" "$out/messages"
    reported=$?
    [ "$log" = "$imu" ] && [ $reported -eq 0 ] && { echo "$policy: rad/s is reported"; exit 1; }
    [ "$log" != "$imu" ] && [ $reported -ne 0 ] && { echo "$policy: deg/s is not reported"; exit 1; }
  done
done
exit 0
