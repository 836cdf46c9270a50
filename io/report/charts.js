// Time charts with common zoom and cursor.

const charts = [];
let timeWindow = null;  // null: the whole flight
let pointed = null;     // sample at the cursor
const windowListeners = [];
const pointListeners = [];

// Lines: {label, column, color, width, band: column of standard deviations}. Without a column the value
// is zero. The edges of the +-3 sigma band are series, so that the value range includes them, clipped to
// 10 times the median half width. The band is drawn as one polygon, faster than dygraphs' error bars.
const center = (line, i) => line.column ? columns[line.column][i] : 0;
const halfWidth = (line, i) => 3 * columns[line.band][i];
const edges = line => line.band ? [`${line.label} low`, `${line.label} high`] : [];

function maxBand(line) {
  const sorted = Array.from(time, (t, i) => halfWidth(line, i)).filter(Number.isFinite).sort((a, b) => a - b);
  return 10 * sorted[sorted.length >> 1];
}

function rowsOf(lines) {
  const limits = lines.map(line => line.band ? maxBand(line) : 0);
  return Array.from(time, (t, i) => [t, ...lines.flatMap((line, k) => {
    const value = center(line, i);
    const edge = line.band ? Math.min(halfWidth(line, i), limits[k]) : 0;
    return line.band ? [value, value - edge, value + edge].map(finite) : [finite(value)];
  })]);
}

function seriesOf(lines) {
  const hidden = {plotter: () => {}, highlightCircleSize: 0};
  return Object.fromEntries(lines.flatMap(line => [
    [line.label, {strokeWidth: line.width || 1.4}], ...edges(line).map(label => [label, hidden])]));
}

const colorsOf = lines => lines.flatMap(line => [color(line.color), ...edges(line).map(() => 'transparent')]);

function drawBand(context, graph, line) {
  const [from, to] = graph.xAxisRange();
  const x = time.map(t => graph.toDomXCoord(t));
  const flush = (start, end) => {
    context.beginPath();
    for (let i = start; i < end; ++i) context.lineTo(x[i], graph.toDomYCoord(center(line, i) + halfWidth(line, i)));
    for (let i = end - 1; i >= start; --i) context.lineTo(x[i], graph.toDomYCoord(center(line, i) - halfWidth(line, i)));
    context.fill();
  };
  context.fillStyle = color(`${line.color}_band`);
  const first = Math.max(0, time.findIndex(t => t >= from) - 1);
  let start = first;
  for (let i = first; i < time.length; ++i) {
    if (Number.isNaN(center(line, i) + halfWidth(line, i))) {
      flush(start, i);
      start = i + 1;
    } else if (time[i] > to || i + 1 === time.length) {
      flush(start, i + 1);
      return;
    }
  }
}

// Lines with data.
const isDrawn = name => columns[name] && columns[name].some(value => !Number.isNaN(value));
const present = lines => lines.filter(line => isDrawn(line.column || line.band));

function setWindow(range, source) {
  timeWindow = range;
  byId('reset').hidden = range === null;
  for (const chart of charts) {
    if (chart === source) continue;
    chart.stale = true;
    if (chart.visible) refresh(chart);
  }
  for (const listener of windowListeners) listener();
}

function refresh(chart) {
  chart.stale = false;
  chart.busy = true;
  chart.graph.updateOptions({dateWindow: timeWindow, valueRange: chart.range});
  chart.busy = false;
}

function setPoint(row, source) {
  pointed = row;
  for (const chart of charts) {
    if (chart === source || !chart.visible) continue;
    if (row === null) chart.graph.clearSelection(); else chart.graph.setSelection(row);
  }
  for (const listener of pointListeners) listener();
}

// Only the last chart of a card has a time axis.
function addChart(card, title, unit, lines, {height = 110, range = null, stacked = false, timeAxis = false} = {}) {
  const drawn = present(lines);
  if (!drawn.length) return;
  const {plot, readout: values} = addPlot(card, title, unit, height + (timeAxis ? 18 : 0));
  const chart = {range, visible: true, stale: false, busy: true, lines: drawn};
  const last = timeRange => Math.abs(timeRange[0] - time[0]) < 1e-6 && Math.abs(timeRange[1] - duration) < 1e-6;
  const options = {
    labels: ['time', ...drawn.flatMap(line => [line.label, ...edges(line)])],
    colors: colorsOf(drawn),
    series: seriesOf(drawn),
    underlayCallback: (context, area, graph) => {
      for (const line of drawn) if (line.band) drawBand(context, graph, line);
    },
    stackedGraph: stacked,
    valueRange: range,
    includeZero: stacked,
    fillAlpha: 0.55,
    dateWindow: timeWindow,
    ...plotOptions({timeAxis, pixelsPerLabel: 18}),
    highlightCallback: (event, t, points, row) => setPoint(row, chart),
    unhighlightCallback: () => setPoint(null, chart),
    drawCallback: (graph, initial) => {
      if (initial || chart.busy) return;
      const shownRange = graph.xAxisRange();
      setWindow(last(shownRange) ? null : shownRange, chart);
    }
  };
  chart.graph = new Dygraph(plot, rowsOf(drawn), options);
  chart.busy = false;
  chart.readout = values;
  plot.chart = chart;
  charts.push(chart);
}

// Time and values at the cursor; topmost line first.
function readout(chart) {
  if (pointed === null) return [];
  const values = chart.lines.filter(line => line.column).reverse().map(line => {
    const value = element('i', {textContent: `${line.short || ''} ${shown(columns[line.column][pointed])}`});
    value.style.color = color(line.color);
    return value;
  });
  return [`${shown(time[pointed])} s`, ...values];
}

pointListeners.push(() => {
  for (const chart of charts) chart.readout.replaceChildren(...readout(chart));
});

// Updates charts once they become visible.
function watchVisibility() {
  const observer = new IntersectionObserver(entries => {
    for (const entry of entries) {
      const chart = entry.target.chart;
      chart.visible = entry.isIntersecting;
      if (chart.visible && chart.stale) refresh(chart);
    }
  }, {rootMargin: '200px'});
  document.querySelectorAll('.plot').forEach(plot => observer.observe(plot));
}

// `redraw` redraws the canvases; dygraphs redraws its charts, except for a change of colours.
function watchPage(redraw) {
  byId('reset').addEventListener('click', () => setWindow(null, null));
  window.addEventListener('resize', redraw);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    for (const chart of charts) {
      chart.graph.updateOptions({colors: colorsOf(chart.lines), ...plotColors()});
    }
    redraw();
  });
}
