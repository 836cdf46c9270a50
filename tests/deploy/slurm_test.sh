#!/usr/bin/env bash
# A study through Snakemake on Slurm, one of its jobs killed: only the flights that it had not
# finished run again, and the results equal those of a local run, times and memory aside.
# usage: slurm_test.sh STILLKITE SOURCE OUT
set -euo pipefail
stillkite=$1 source=$2 out=$3
rm -rf "$out"
mkdir -p "$out"
cd "$out"
fail() { echo "$1"; tail -n 50 messages cluster/shards/*.log; exit 1; }

"$stillkite" simulate "$source/configs/simulate_demo.yaml" --out flight --set flight.duration_s=30 \
  --set camera.width_px=320 --set camera.height_px=240 >messages 2>&1
cat >study.yaml <<'END'
flights: {flight: flight/run.yaml}
configurations:
  {a: {}, b: {source.end_s: 29}, c: {source.end_s: 28}, d: {source.end_s: 27}, e: {source.end_s: 26},
   f: {source.end_s: 25}}
END
"$stillkite" batch study.yaml --out local --jobs 1 >messages 2>&1

CI=true snakemake --snakefile "$source/deploy/Snakefile" --profile "$source/deploy/slurm" \
  --config study=study.yaml out=cluster shards=2 stillkite="$stillkite" >messages 2>&1 &
snakemake=$!
until [[ -f cluster/jobs/flight-a.json && -f cluster/jobs/flight-b.json ]]; do
  kill -0 "$snakemake" 2>/dev/null || fail "the study ended early"
  sleep 0.05
done
job=$(squeue --noheader --format=%i --states=RUNNING | head -n 1)
scontrol listpids "$job" | awk 'NR > 1 && $1 > 0 { print $1 }' | xargs kill -KILL
wait "$snakemake" || fail "the study failed"

grep -h 'jobs finished' cluster/shards/?-of-2.log | sed 's/[12] of them/some of them/' | sort >counts
printf '3 of 3 jobs finished, %s of them before\n' 0 some | diff counts - ||
  fail "other flights than the unfinished ones ran again"
grep -q '^6 of 6 jobs finished, 6 of them before' cluster/shards/study.log ||
  fail "flights ran outside the shards"

for id in flight-{a..f}; do
  cmp "local/jobs/$id.yaml" "cluster/jobs/$id.yaml"
  cmp "local/jobs/$id/trajectory.tum" "cluster/jobs/$id/trajectory.tum"
done
# all figures but times and memory
figures() {
  python3 - "$1" <<'END'
import csv, sys
for row in csv.DictReader(open(sys.argv[1])):
    print({key: value for key, value in row.items()
           if key != "wall_s" and not key.startswith(("timing.", "memory."))})
END
}
diff <(figures local/study.csv | sort) <(figures cluster/study.csv | sort)
[[ $(figures cluster/study.csv | wc -l) == 6 ]]
