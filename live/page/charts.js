// History: verdicts of the last 5 minutes, charts of the last 60 s.

const kHistory_s = 300, kChart_s = 60, kInterval_s = 0.25;
const kMeasured = ['ok', 'first_frame', 'still'];
let samples = [];  // {number, time, speed, height, displacement, latency, verdict}

const chartList = [
  {key: 'speed', name: 'Speed', unit: () => `${lengthUnit}/s`, digits: 2, least: 0.2},
  {key: 'height', name: 'Height', unit: () => lengthUnit, digits: 2, least: 0.2, floats: true},
  {key: 'displacement', name: 'Displacement', unit: () => 'm', digits: 2, least: 0.2},
  {key: 'latency', name: 'Latency', unit: () => 'ms', digits: 0, least: 20},
];
let lengthUnit = 'm';

for (const chart of chartList) {
  const place = document.createElement('div');
  place.className = 'chart';
  chart.label = document.createElement('div');
  chart.label.className = 'name';
  chart.canvas = document.createElement('canvas');
  chart.canvas.id = `chart-${chart.key}`;
  place.append(chart.label, chart.canvas);
  byId('charts').append(place);
}

function addSamples(rows) {
  const now = performance.now() / 1000;
  for (const [number, age, speed, height, displacement, latency, verdict] of rows) {
    samples.push({number, time: now + age, speed, height, displacement, latency, verdict});
  }
  samples = samples.filter(sample => now - sample.time < kHistory_s);
}

// Range of the chart's values; a level quantity starts at zero.
function rangeOf(chart, values) {
  const max = Math.max(...values), min = chart.floats ? Math.min(...values) : 0;
  if (max - min >= chart.least) return [min, max];
  const middle = (min + max) / 2;
  return chart.floats ? [middle - chart.least / 2, middle + chart.least / 2] : [0, chart.least];
}

function drawChart(chart, now) {
  const {context, width, height} = fitted(chart.canvas);
  const known = samples.filter(sample => now - sample.time < kChart_s && Number.isFinite(sample[chart.key]));
  chart.label.textContent = `${chart.name}, ${chart.unit()}`;
  const left = 46, bottom = height - 18, top = 8;
  context.font = '13px system-ui, sans-serif';
  context.fillStyle = '#000';
  context.fillText('60 s ago', left, height - 3);
  context.fillText('now', width - 26, height - 3);
  context.strokeStyle = '#999';
  context.lineWidth = 1;
  context.strokeRect(left, top, width - left - 1, bottom - top);
  if (!known.length) return;
  const [min, max] = rangeOf(chart, known.map(sample => sample[chart.key]));
  context.textAlign = 'right';
  context.fillText(max.toFixed(chart.digits), left - 4, top + 10);
  context.fillText(min.toFixed(chart.digits), left - 4, bottom);
  context.strokeStyle = '#0046b8';
  context.lineWidth = 2.5;
  context.beginPath();
  let before = -Infinity;
  for (const sample of known) {
    const x = left + (width - left) * (1 - (now - sample.time) / kChart_s);
    const y = bottom - (bottom - top) * (sample[chart.key] - min) / (max - min);
    if (sample.time - before > 4 * kInterval_s) context.moveTo(x, y); else context.lineTo(x, y);
    before = sample.time;
  }
  context.stroke();
}

// Green: measured, red and full height: not measured, empty: no image.
function drawVerdicts(now) {
  const {context, width, height} = fitted(byId('verdict-strip'));
  context.fillStyle = '#ddd';
  context.fillRect(0, 0, width, height);
  const perSecond = width / kHistory_s;
  const times = {};
  for (const sample of samples) {
    const isMeasured = kMeasured.includes(sample.verdict);
    context.fillStyle = isMeasured ? '#4caf78' : '#b00020';
    const x = width - perSecond * (now - sample.time);
    const top = isMeasured ? 8 : 0;
    // wide enough to join the next one
    const interval = Math.max(1.3 * perSecond * kInterval_s, 1.5);
    context.fillRect(x - interval, top, interval, height - top);
    if (!isMeasured) times[sample.verdict] = (times[sample.verdict] || 0) + kInterval_s;
  }
  const texts = Object.entries(times).map(([verdict, time]) => `${verdict.replaceAll('_', ' ')} ${time.toFixed(1)} s`);
  byId('verdict-times').textContent = texts.length ? `Not measured: ${texts.join(', ')}` : 'All images measured';
}

function drawHistory() {
  const now = performance.now() / 1000;
  for (const chart of chartList) drawChart(chart, now);
  drawVerdicts(now);
}

