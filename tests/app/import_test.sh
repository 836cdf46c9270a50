#!/bin/sh
# A video with DJI subtitles of a simulated flight: import and run, in two commands.
# usage: import_test.sh STILLKITE SIMULATED_FLIGHT OUT
stillkite=$1 flight=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cp "$flight/flight.mp4" "$out/DJI_0001.MP4"
# one subtitle per pose; 47 deg north, WGS 84: 111 177 m and 76 057 m per degree
awk '$1 != "#" {
  ms = int($1 * 1000 + 0.5)
  printf "%d\n00:00:%02d,%03d --> 00:00:%02d,%03d\n", ++n, ms / 1000, ms % 1000, ms / 1000, ms % 1000
  printf "[latitude: %.8f] [longitude: %.8f] [rel_alt: %.3f abs_alt: %.3f]\n\n",
         47 + $3 / 111177, 8 + $2 / 76057, $4, $4 + 400
}' "$flight/truth.tum" > "$out/DJI_0001.SRT"
"$stillkite" import "$out/DJI_0001.MP4" --calibration "$flight/sensor.yaml" --out "$out/flight" \
  > "$out/notes" || exit 1
cat "$out/notes"
for line in "found    log: .*DJI_0001.SRT" "missing  imu" "found    mount" "assumed  initial height"; do
  grep -q "^$line" "$out/notes" || { echo "no line '$line'"; exit 1; }
done
# subtitles have no attitude: that of the simulated start
"$stillkite" run "$out/flight/flight.yaml" --set initial.yaw_deg=1.69 --set initial.pitch_deg=-0.4 \
  --set initial.roll_deg=1.46 --out "$out/run" --json > "$out/summary.json" || exit 1
awk '/"position_rmse_m"/ { sub(/,/, "", $2); print "position_rmse_m", $2; ok = $2 < 0.1 }
     END { exit !ok }' "$out/summary.json"
