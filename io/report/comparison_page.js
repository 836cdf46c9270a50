// Fills the cards of the page.

const path = {time_s: pathTime};
const pathLines = () => paths;
const keysOf = isShown => runs.flatMap((run, i) => isShown(run, i) ? [[run.name, runColor(i)]] : []);
const keyOfTruth = truth ? [['truth', 'truth', 'thick']] : [];

function addComparedCharts(id, charts, {withTruth = false, ...options} = {}) {
  const drawn = charts.filter(([, , column]) => present(compared(column)).length);
  byId(id).hidden = !drawn.length;
  if (!drawn.length) return;
  const isShown = (run, i) => drawn.some(([, , column]) => isDrawn(`${i} ${column}`));
  addKeys(byId(id), [...keysOf(isShown), ...(withTruth ? keyOfTruth : [])]);
  drawn.forEach(([title, unit, column], i) =>
    addChart(byId(id), title, unit, compared(column), {timeAxis: i + 1 === drawn.length, ...options}));
}

function addStrips() {
  const counts = {};
  runs.forEach((run, i) => {
    const entry = entries[i] || {};
    for (const [verdict, count] of Object.entries(entry.verdicts || {})) counts[verdict] = (counts[verdict] || 0) + count;
    byId('strips').append(
      element('div', {className: 'strip-head'}, element('span', {}, runSwatch(i), run.name),
              element('span', {textContent: `${shown(percent(entry.availability_ratio))} % of the frames with an estimate`})),
      element('div', {className: 'strip'}));
  });
  addVerdictLegend(counts);
}

function drawVerdicts() {
  document.querySelectorAll('#strips .strip').forEach((place, i) => drawStrip(place, runs[i].verdicts));
}

function drawCanvases() {
  drawVerdicts();
  drawPath();
}

drawSubtitle();
drawResult();
addStrips();
byId('path').hidden = !paths.length;
addKeys(byId('path'), [...keysOf(run => run.path), ...keyOfTruth]);
addComparedCharts('position', [...'xyz'].map(axis => [axis, lengthUnit, `position_${axis}_m`]), {withTruth: true});
addComparedCharts('error', [['position', 'm', 'position_error_m'], ['velocity', 'm/s', 'velocity_error_m_s'],
                            ['attitude', '°', 'attitude_error_deg']]);
addComparedCharts('speed', [['speed', speedUnit, 'speed_m_s']], {withTruth: true, height: 200});
addComparedCharts('timing', [['estimator only', 'ms', 'frame_ms']], {height: 200});
drawDifferences();
drawCanvases();
watchVisibility();
watchPage(drawCanvases);
document.documentElement.dataset.ready = String(charts.length);
