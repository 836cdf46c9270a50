#!/bin/bash
# Live flight over UDP on this machine, with sensor lines: the sender of the video starts late, is
# silent for two seconds, and the process is killed. The record reproduces every estimate, and the page
# shows it.
# usage: fly_test.sh STILLKITE VIDEO CALIBRATION OUT
set -u
stillkite=$1 video=$2 calibration=$3 out=$4
command -v ffmpeg > /dev/null || { echo "skipped: ffmpeg is missing"; exit 0; }
fail() { echo "$1"; cat "$out/messages"; exit 1; }
rm -rf "$out" && mkdir -p "$out"
port=38631 sensor_port=38632
cat > "$out/flight.yaml" << END
source: {path: "udp://127.0.0.1:$port", timeout_s: 0.5}
calibration: {path: $calibration}
live:
  json: "-"
  telemetry: {imu: JSON, attitude: JSON, height: JSON_RANGE, json: "udp://:$sensor_port"}
END
python3 - $sensor_port << 'END' &
import json, socket, sys, time
link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
for i in range(10**6):
    line = {"schema": 1, "timestamp": time.monotonic_ns() + 10**9, "range": 20 + 0.01 * (i % 7),
            "attitude": [1, 0, 0, 0], "angular_rate": [0.001 * (i % 5), 0, 0],
            "specific_force": [0, 0, 9.81]}
    if i % 10 == 9:
        line["range"] = "far"
    link.sendto(json.dumps(line).encode(), ("127.0.0.1", int(sys.argv[1])))
    time.sleep(0.02)
END
sensors=$!
trap 'kill $sensors' EXIT
send() {
  ffmpeg -v error -re "$@" -i "$video" -c:v libx264 -preset ultrafast -tune zerolatency -g 5 \
    -f mpegts "udp://127.0.0.1:$port?pkt_size=1316" || fail "ffmpeg cannot send"
}
"$stillkite" fly "$out/flight.yaml" --out "$out/flight" > "$out/estimates.json" 2> "$out/messages" &
pid=$!
sleep 0.5
send -stream_loop 3
before=$(wc -l < "$out/estimates.json")
[ "$before" -gt 5 ] || fail "only $before estimates"
sleep 2
grep -q "no packet for 0.5 s" "$out/messages" || fail "silence is not reported"
send -stream_loop 3
[ "$(wc -l < "$out/estimates.json")" -gt $((before + 5)) ] || fail "no estimates after the silence"
[ "$(grep -c connected "$out/messages")" -eq 2 ] || fail "the new connection is not reported"
grep -q "a line is rejected: range: expected a number" "$out/messages" ||
  fail "damaged sensor lines are not reported"
kill -9 $pid
wait $pid 2> /dev/null
"$stillkite" run "$out/flight" --out "$out/again" > /dev/null || fail "the record cannot be read"
# all columns but the times of the stages, which are the last four
without_times() { sed -E 's/(,[^,]*){4}$//'; }
rows=$(($(wc -l < "$out/again/estimates.csv")))
[ "$rows" -gt 10 ] || fail "only $rows rows from the record"
grep -q ",range," "$out/again/estimates.csv" || fail "the range finder is not used"
[ "$(grep -c ",sensors$" "$out/flight/telemetry.csv")" -gt 100 ] || fail "sensor lines are missing"
# killed between the row of an image and its estimate, the record has one image more
recorded=$(wc -l < "$out/flight/estimates.csv")
[ $((rows - recorded)) -le 1 ] || fail "$recorded rows in flight, $rows from the record"
diff <(head -n "$recorded" "$out/flight/estimates.csv" | without_times) \
  <(head -n "$recorded" "$out/again/estimates.csv" | without_times) ||
  fail "estimates from the record differ"
# the record on the page: commands are refused, the flight ends
"$stillkite" replay "$out/flight" --listen 127.0.0.1:28633 --speed 50 2> "$out/messages" &
replay=$!
trap 'kill $sensors $replay' EXIT
python3 - 28633 << 'END' || fail "the replay is not shown"
import json, sys, time, urllib.error, urllib.request
def request(path, body=None):
    url = f"http://127.0.0.1:{sys.argv[1]}{path}"
    return urllib.request.urlopen(urllib.request.Request(url, body, {"X-Operator": "0" * 32}), timeout=3)
for _ in range(200):
    time.sleep(0.1)
    try:
        flight = json.load(request("/state"))["flight"]
    except urllib.error.URLError:
        continue  # not started
    if flight["replay"] and flight["replay"]["ended"]:
        break
assert flight["replay"]["ended"] and flight["replay"]["speed"] == 50, flight["replay"]
assert flight["estimate"]["scale"]["source"] == "range", flight["estimate"]
assert flight["estimate"]["latency_ms"] is None, flight["estimate"]
assert "End of the record" in flight["alarms"], flight["alarms"]
assert request("/image").status == 200
for path in ("/take_control", "/command"):
    try:
        request(path, b'{"command": "engage"}')
        raise SystemExit(f"{path} is accepted")
    except urllib.error.HTTPError as error:
        assert error.code == 409, error
END
kill -TERM $replay
wait $replay
[ $? -eq 130 ] || fail "exit status of an ended replay"
trap 'kill $sensors' EXIT
exit 0
