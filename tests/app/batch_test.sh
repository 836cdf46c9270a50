#!/bin/sh
# A study in processes: a failing flight, a changed key, shards, two calls at once, Ctrl-C and kill -9.
# usage: batch_test.sh STILLKITE FLIGHT_YAML EUROC_DATA_SET OUT
stillkite=$1 flight=$2 dataset=$3 out=$4
rm -rf "$out" "$out.source"
mkdir -p "$out.source/mav0/cam0"
study=$out.source/study.yaml

fail() { echo "$1"; cat "$out.messages"; ls -R "$out"; exit 1; }
# batch STATUS PATTERN ARGUMENTS...: exit status, and a line of stdout or stderr
batch() {
  status=$1 pattern=$2
  shift 2
  "$stillkite" batch "$study" --out "$out" "$@" > "$out.messages" 2>&1
  found=$?
  [ $found -eq "$status" ] || fail "exit status $found, expected $status: $*"
  grep -q -- "$pattern" "$out.messages" || fail "missing '$pattern': $*"
}

# One flight fails: the other's jobs finish, and only the failed ones run again.
echo '{source: {path: none.mp4}, initial: {height_m: 20}}' > "$out.source/broken.yaml"
cat > "$study" <<END
flights: {good: $flight, broken: broken.yaml}
configurations: {whole: {}, start: {source.end_s: 0.2}}
END
batch 1 '2 of 4 jobs finished, 0 of them before'
grep -q 'broken-whole.*failed: .*none.mp4' "$out.messages" || fail "the failure is not reported"
grep -q '^good-start,good,start,,,finished' "$out/study.csv" || fail "study.csv lacks a job"
[ -s "$out/jobs/good-whole/report.html" ] || fail "a report is missing"
batch 1 '2 of 4 jobs finished, 2 of them before'
grep -q '^\[2/2\] broken-' "$out.messages" || fail "other jobs than the failed ones ran"

# A changed key: only its job runs again. Metrics are not part of a job.
cat > "$study" <<END
flights: {good: $flight}
configurations: {whole: {}, start: {source.end_s: 0.3}}
metrics: [frames.read]
END
batch 0 'finished good-whole' --list
batch 0 'pending  good-start' --list
batch 0 '2 of 2 jobs finished, 1 of them before'
batch 0 '2 of 2 jobs finished, 2 of them before'

# Shards: a failed job does not fail its shard, and the call without --shard writes the table.
cat > "$study" <<END
flights: {good: $flight, broken: broken.yaml}
configurations: {whole: {}, start: {source.end_s: 0.2}}
END
rm -r "$out"
batch 0 '^1 of 2 jobs finished, 0 of them before' --shard 1/2
[ ! -e "$out/study.csv" ] || fail "a shard wrote a table"
batch 0 '^1 of 2 jobs finished, 0 of them before' --shard 2/2
batch 2 "'3/2'; expected K/N with K from 1 to N" --shard 3/2
batch 1 '^2 of 4 jobs finished, 2 of them before'

# A long job: the images of a data set, repeated.
cam0=$out.source/mav0/cam0
cp -r "$dataset/mav0/cam0/data" "$dataset/mav0/cam0/sensor.yaml" "$cam0"
grep -v '^#' "$dataset/mav0/cam0/data.csv" | tr -d '\r' | awk -F, '
  { name[NR] = $2 }
  END { for (i = 1; i <= 20000; ++i) printf "%d0000000,%s\n", i, name[i % NR + 1] }' > "$cam0/data.csv"
echo '{source: {path: .}, initial: {height_m: 20}}' > "$out.source/long.yaml"
cat > "$study" <<END
flights: [long.yaml]
configurations: {quick: {source.end_s: 0.05}, slow: {}}
END

# Starts the study, one job at a time, and waits for the long job. Arguments are those of batch.
start_slow() {
  "$stillkite" batch "$study" --out "$out" --jobs 1 "$@" > "$out.messages" 2>&1 &
  pid=$!
  tries=0
  # a killed call leaves a part file with the number of its process
  until slow=$(ls "$out/jobs/long-slow" 2> /dev/null | sed -n 's/^estimates.csv.\([0-9]*\).part$/\1/p') &&
    [ -n "$slow" ] && kill -0 "$slow" 2> /dev/null; do
    tries=$((tries + 1))
    [ $tries -gt 1000 ] && fail "the long job did not start"
    sleep 0.02
  done
}
# The long job has ended and has no record.
expect_stopped() {
  tries=0
  while kill -0 "$slow" 2> /dev/null; do
    tries=$((tries + 1))
    [ $tries -gt 500 ] && fail "the long job still runs"
    sleep 0.02
  done
  batch 0 'finished long-quick' --list
  batch 0 'pending  long-slow' --list
}

start_slow
"$stillkite" batch "$study" --out "$out" > "$out.second" 2>&1
[ $? -eq 2 ] || fail "a second call in the same folder was accepted"
grep -q 'another process writes to this folder' "$out.second" || fail "missing message"
"$stillkite" batch "$study" --out "$out" --shard 1/2 > "$out.second" 2>&1
[ $? -eq 2 ] || fail "a shard was accepted in the folder of a whole study that runs"
kill -KILL $pid
wait $pid 2> /dev/null
expect_stopped

start_slow
kill -INT $pid
wait $pid
status=$?
[ $status -eq 130 ] || fail "exit status $status, expected 130"
grep -q '1 of 2 jobs finished, 1 of them before' "$out.messages" || fail "a finished job ran again"
expect_stopped

# Shards run at the same time; the whole study does not run meanwhile.
start_slow --shard 2/2
"$stillkite" batch "$study" --out "$out" --shard 1/2 > "$out.second" 2>&1 ||
  fail "a second shard was rejected"
"$stillkite" batch "$study" --out "$out" > "$out.second" 2>&1
[ $? -eq 2 ] || fail "the whole study was accepted while a shard runs"
kill -KILL $pid
wait $pid 2> /dev/null
expect_stopped
exit 0
