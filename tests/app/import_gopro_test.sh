#!/bin/sh
# GoPro's walk, stabilized: the imported gyroscope explains the rotation of the images but for the
# frame by which the camera's orientations are early.
# usage: import_gopro_test.sh STILLKITE OUT
stillkite=$1 out=$2 video=$STILLKITE_DATA/../cases/logs/gopro_walk.mp4
[ -n "$STILLKITE_DATA" ] && [ -f "$video" ] || { echo "skipped: no $video"; exit 0; }
rm -rf "$out"
"$stillkite" import "$video" --out "$out/flight" || exit 1
"$stillkite" run "$out/flight/flight.yaml" --set estimator.policy=reference --out "$out/early" \
  2>&1 | tee "$out/messages"
grep -q "add +0.03[0-9] to time_offset_s) would explain \(9.\|100\) %" "$out/messages" || exit 1
"$stillkite" run "$out/flight/flight.yaml" --set imu.time_offset_s=0.033 \
  --set attitude.time_offset_s=0.033 --set initial.height_m=1.6 --out "$out/run" \
  2>&1 | tee "$out/messages"
! grep -q "gyroscope and image rotations disagree" "$out/messages"
