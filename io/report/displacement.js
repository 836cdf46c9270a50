// Charts of the displacement along the moved axis over time, one chart per set of trials.

const displacementCharts = [];

// One row per time stamp of any trial: null without a sample of a trial (line connected), NaN for a
// sample without a value (line broken).
function rowsOfSet(set) {
  const rows = new Map();
  set.forEach((trial, place) => trial.chart.time_s.forEach((t, i) => {
    if (Number.isNaN(t)) return;
    if (!rows.has(t)) rows.set(t, [t, ...set.map(() => null)]);
    const value = trial.chart.displacement_m[i];
    rows.get(t)[place + 1] = Number.isFinite(value) ? value : NaN;
  }));
  return [...rows.values()].sort((a, b) => a[0] - b[0]);
}

const colorsOfSet = set => set.map(trial => color(trial.state));

function addDisplacementChart(axis) {
  const set = trialsOf(axis);
  const rows = rowsOfSet(set);
  if (!rows.length) return;
  const {plot, readout} = addPlot(byId('displacement'), `station moved along ${axis}: d`, 'm', 190);
  const labels = set.map((trial, i) => `${i + 1} ${trial.state}`);
  const graph = new Dygraph(plot, rows, {
    labels: ['time', ...labels],
    colors: colorsOfSet(set),
    series: Object.fromEntries(set.map((trial, i) => [labels[i], {strokeWidth: trial.stabilized ? 1 : 2}])),
    connectSeparatedPoints: true,
    includeZero: true,
    ...plotOptions({timeAxis: true, pixelsPerLabel: 26}),
    highlightCallback: (event, t, points, row) => {
      readout.replaceChildren(`${shown(t)} s`, ...set.map((trial, i) =>
        element('i', {textContent: shown(rows[row][i + 1], 3), className: trial.state})));
    },
    unhighlightCallback: () => readout.replaceChildren(),
    drawCallback: () => {
      byId('reset').hidden = !displacementCharts.some(chart => chart.graph.isZoomed());
    }
  });
  plot.chart = {graph, set};
  displacementCharts.push(plot.chart);
}

function drawDisplacements() {
  addKeys(byId('displacement'), stateKeys);
  flownAxes.forEach(addDisplacementChart);
  byId('reset').addEventListener('click', () => displacementCharts.forEach(chart => chart.graph.resetZoom()));
}
