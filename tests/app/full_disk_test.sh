#!/bin/sh
# Run on a full disk into the folder of an earlier run: exit status 1, and no results that look
# complete.
# usage: full_disk_test.sh STILLKITE CONFIG OUT
stillkite=$1 config=$2 out=$3
rm -rf "$out"
"$stillkite" run "$config" --out "$out" > /dev/null 2>&1 || { echo "the first run failed"; exit 1; }
(ulimit -f 4; "$stillkite" run "$config" --set source.start_s=0.1 --out "$out" > /dev/null 2> "$out.messages")
status=$?
cat "$out.messages"
[ $status -eq 1 ] || { echo "exit status $status, expected 1"; exit 1; }
grep -q "cannot be written" "$out.messages" || { echo "missing error message"; exit 1; }
[ -e "$out/report.html" ] && { echo "the earlier report still exists"; exit 1; }
grep -q '"source_complaint": null' "$out/summary.json" 2> /dev/null && { echo "the summary reports no problem"; exit 1; }
ls "$out" | grep part && { echo "a partial file is left"; exit 1; }
exit 0
