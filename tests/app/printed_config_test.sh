#!/bin/sh
# A printed fused configuration is printed unchanged, gives the same trajectory, and leaves the keys
# of other policies alone. The report of a run without scale shows the keys that it derived.
# usage: printed_config_test.sh STILLKITE CONFIG OUT
stillkite=$1 config=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
fused="--set estimator.policy=fused --set initial.from_truth=false"
changed="--set reference.renew_below_ratio=0.5"

"$stillkite" config "$config" $fused $changed > "$out/fused.yaml" || exit 1
"$stillkite" config "$out/fused.yaml" | cmp - "$out/fused.yaml" || exit 1
grep "renew_below_ratio: 0.5 .*replaces" "$out/fused.yaml" || { echo "the ratio of the fusion is not the effective one"; exit 1; }

"$stillkite" run "$config" $fused $changed --out "$out/original" > /dev/null || exit 1
"$stillkite" run "$out/fused.yaml" --out "$out/printed" > /dev/null || exit 1
cmp "$out/original/trajectory.tum" "$out/printed/trajectory.tum" || exit 1
grep "depth_correlated_frames: 300 " "$out/original/report.html" || { echo "the report has another configuration than the run"; exit 1; }

"$stillkite" config "$config" $fused > "$out/default.yaml" || exit 1
"$stillkite" config "$out/default.yaml" --set estimator.policy=reference > "$out/other.yaml" || exit 1
"$stillkite" config "$config" --set initial.from_truth=false --set estimator.policy=reference | cmp - "$out/other.yaml"
