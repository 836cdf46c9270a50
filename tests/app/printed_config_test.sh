#!/bin/sh
# A printed fused configuration has the values that run, is printed unchanged and gives the same
# trajectory. Given another policy, it differs from that policy's in the derived keys only.
# usage: printed_config_test.sh STILLKITE CONFIG OUT
stillkite=$1 config=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
fused="--set estimator.policy=fused --set initial.from_truth=false"
changed="--set reference.renew_below_ratio=0.5"

"$stillkite" config "$config" $fused $changed > "$out/fused.yaml" || exit 1
"$stillkite" config "$out/fused.yaml" | cmp - "$out/fused.yaml" || exit 1
[ "$(grep -c "renew_below_ratio: 0.5 " "$out/fused.yaml")" = 2 ] || { echo "a ratio is not the effective one"; exit 1; }
for value in "depth_correlated_frames: 300" "inverse_depth_sigma_ratio: 0.5" "relinearize_start: false"; do
  grep "$value " "$out/fused.yaml" || { echo "without a scale $value is the effective one"; exit 1; }
done

"$stillkite" run "$config" $fused $changed --out "$out/original" > /dev/null || exit 1
"$stillkite" run "$out/fused.yaml" --out "$out/printed" > /dev/null || exit 1
cmp "$out/original/trajectory.tum" "$out/printed/trajectory.tum" || exit 1
grep "depth_correlated_frames: 300 " "$out/original/report.html" || { echo "the report has another configuration than the run"; exit 1; }

"$stillkite" config "$config" $fused > "$out/default.yaml" || exit 1
"$stillkite" config "$out/default.yaml" --set estimator.policy=reference > "$out/printed.yaml" || exit 1
"$stillkite" config "$config" --set initial.from_truth=false --set estimator.policy=reference > "$out/other.yaml" || exit 1
changed=$(diff "$out/other.yaml" "$out/printed.yaml" | sed -n 's/^> *\([a-z_.]*: [^ ]*\).*/\1/p' | tr '\n' ' ')
[ "$changed" = "renew_below_ratio: 0.3 inverse_depth_sigma_ratio: 0.5 depth_correlated_frames: 300 relinearize_start: false " ] ||
  { echo "changed keys: $changed"; exit 1; }
