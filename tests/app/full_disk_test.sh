#!/bin/sh
# A run that finds no room for its results beside those of an earlier one: status 1, and what is
# left does not look like a run that has come to its end.
# usage: full_disk_test.sh STILLKITE CONFIG OUT
stillkite=$1 config=$2 out=$3
rm -rf "$out"
"$stillkite" run "$config" --out "$out" > /dev/null 2>&1 || { echo "the first run failed"; exit 1; }
(ulimit -f 4; "$stillkite" run "$config" --set source.start_s=0.1 --out "$out" > /dev/null 2> "$out.messages")
status=$?
cat "$out.messages"
[ $status -eq 1 ] || { echo "exit status $status, expected 1"; exit 1; }
grep -q "cannot be written" "$out.messages" || { echo "it does not say so"; exit 1; }
[ -e "$out/report.html" ] && { echo "the earlier report is left"; exit 1; }
grep -q '"source_complaint": null' "$out/summary.json" 2> /dev/null && { echo "the summary looks whole"; exit 1; }
ls "$out" | grep part && { echo "half a file is left"; exit 1; }
exit 0
