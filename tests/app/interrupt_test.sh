#!/bin/sh
# Ctrl-C during a run: exit status 130, results so far written, no partial files. The source repeats
# a data set's images, so that no machine finishes before the signal.
# usage: interrupt_test.sh STILLKITE run|compare EUROC_DATA_SET OUT
stillkite=$1 subcommand=$2 dataset=$3 out=$4
rm -rf "$out" "$out.source"
cam0=$out.source/mav0/cam0
mkdir -p "$cam0"
cp -r "$dataset/mav0/cam0/data" "$dataset/mav0/cam0/sensor.yaml" "$cam0"
grep -v '^#' "$dataset/mav0/cam0/data.csv" | tr -d '\r' | awk -F, '
  { name[NR] = $2 }
  END { for (i = 1; i <= 20000; ++i) printf "%d0000000,%s\n", i, name[i % NR + 1] }' \
  > "$cam0/data.csv"
echo "{source: {path: .}, initial: {height_m: 20}, shadow: {enabled: true}}" > "$out.source/run.yaml"
case $subcommand in
  run) results=$out top_summary=$out/summary.json ;;
  compare) results=$out/reference top_summary=$out/comparison.json ;;
esac
"$stillkite" "$subcommand" "$out.source/run.yaml" --out "$out" > /dev/null 2> "$out.messages" &
pid=$!
tries=0
until ls "$results"/estimates.csv.*.part > /dev/null 2>&1; do
  tries=$((tries + 1))
  [ $tries -gt 1000 ] && { echo "the run did not start"; cat "$out.messages"; exit 1; }
  sleep 0.01
done
kill -INT $pid
wait $pid
status=$?
cat "$out.messages"
[ $status -eq 130 ] || { echo "exit status $status, expected 130"; exit 1; }
grep -q "stopped after" "$out.messages" || { echo "missing message"; exit 1; }
for summary in "$top_summary" "$results/summary.json"; do
  grep -q '"interrupted": true' "$summary" || { echo "$summary: interrupted is not true"; exit 1; }
done
for name in estimates.csv commands.csv trajectory.tum report.html; do
  [ -s "$results/$name" ] || { echo "$name is missing"; exit 1; }
done
[ -s "$out/report.html" ] || { echo "the report is missing"; exit 1; }
ls -R "$out" | grep part && { echo "a partial file is left"; exit 1; }
exit 0
