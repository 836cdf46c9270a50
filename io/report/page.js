// Fills the cards of the page.

const truthLine = column => ({label: 'truth', column, color: 'truth', width: 4});
const estimateLine = (column, band) => ({label: 'estimate', column, band, color: 'estimate'});
const errorLines = (column, band) => [{label: '±3σ', band, color: 'sigma', width: 1},
  {label: 'error', column, color: 'estimate'}];

function addKeysOfEstimate(card, band, more = []) {
  const keys = [['estimate', 'estimate']];
  if (band) keys.push(['±3σ', 'estimate_band', 'band']);
  if (data.has_truth) keys.push(['truth', 'truth', 'thick']);
  addKeys(card, [...keys, ...more]);
}

function addStateCharts() {
  addKeysOfEstimate(byId('position'), true);
  addKeysOfEstimate(byId('velocity'), true);
  addKeysOfEstimate(byId('attitude'), false);
  for (const axis of 'xyz') {
    addChart(byId('position'), axis, lengthUnit,
      [truthLine(`position_true_${axis}_m`), estimateLine(`position_${axis}_m`, `position_sigma_${axis}_m`)], {timeAxis: axis === 'z'});
    addChart(byId('velocity'), `V${axis}`, speedUnit,
      [truthLine(`velocity_true_${axis}_m_s`), estimateLine(`velocity_${axis}_m_s`, `velocity_sigma_${axis}_m_s`)], {timeAxis: axis === 'z'});
  }
  for (const [angle, title] of [['pitch', 'pitch θ, positive nose down'], ['roll', 'roll φ'], ['yaw', 'yaw γ']]) {
    addChart(byId('attitude'), title, '°', [truthLine(`${angle}_true_deg`), estimateLine(`${angle}_deg`)],
      {timeAxis: angle === 'yaw'});
  }
}

function addErrorCharts() {
  byId('errors').hidden = !data.has_truth;
  if (!data.has_truth) return;
  for (const axis of 'xyz') {
    addChart(byId('position_error'), axis, lengthUnit,
      errorLines(`position_error_${axis}_m`, `position_sigma_${axis}_m`), {timeAxis: axis === 'z'});
    addChart(byId('velocity_error'), `V${axis}`, speedUnit,
      errorLines(`velocity_error_${axis}_m_s`, `velocity_sigma_${axis}_m_s`), {timeAxis: axis === 'z'});
    addChart(byId('attitude_error'), `about the world's ${axis}${axis === 'z' ? ' (yaw)' : ''}`, '°',
      errorLines(`attitude_error_${axis}_deg`, `attitude_sigma_${axis}_deg`),
      {timeAxis: axis === 'z'});
  }
  drawErrorTable();
}

function addQualityCharts() {
  const single = (column, name = 'estimate') => [{label: column, column, color: name}];
  const card = byId('quality');
  addChart(card, 'inliers', '%', single('inliers_percent'), {height: 90, range: [0, 103]});
  addChart(card, 'residual', 'px', single('residual_px'), {height: 90});
  addChart(card, 'flow vectors', '', single('windows'), {height: 90});
  addChart(card, 'mean flow', 'px', single('flow_px'), {height: 90});
  addChart(card, 'condition number', '', single('condition'), {height: 90, timeAxis: true});
}

function addTimingCharts() {
  const stages = ['pyramid', 'flow', 'solve', 'filter'];
  addKeys(byId('timing'), stages.map(stage => [stage, stage, 'thick']));
  // dygraphs stacks the first series on top
  const lines = stages.map(stage => ({label: stage, short: stage, column: `${stage}_ms`, color: stage, width: 0.8})).reverse();
  addChart(byId('timing'), 'stacked', 'ms', lines, {height: 240, stacked: true, timeAxis: true});
  const stageMs = (summary.timing || {}).stages_ms || {};
  const known = [...stages, ...Object.keys(stageMs).filter(name => !stages.includes(name))];
  const rows = known.filter(name => name in stageMs).map(name => {
    const value = stageMs[name];
    return value && typeof value === 'object' ? [name, value.median, value.p99] : [name, value];
  });
  if (rows.length) byId('timing').append(table(rows[0].length > 2 ? ['stage', 'median, ms', '99th percentile, ms'] : ['stage', 'ms'], rows));
}

function drawVerdicts() {
  drawStrip(document.querySelector('.strip'), data.verdicts);
}

function pathLines() {
  if (!path.position_x_m) return [];
  const lines = [];
  if (path.position_true_x_m) {
    lines.push({x: path.position_true_x_m, y: path.position_true_y_m, color: 'truth', width: 4});
  }
  lines.push({x: path.position_x_m, y: path.position_y_m, color: 'estimate', width: 1.6, end: 'end'});
  return lines;
}

function drawCanvases() {
  drawVerdicts();
  drawPath();
}

drawHeadline();
addVerdictLegend(summary.verdicts || {});
addKeysOfEstimate(byId('path'), false, [['start', 'start', 'point'], ['end', 'end', 'point']]);
addStateCharts();
addErrorCharts();
addQualityCharts();
addTimingCharts();
drawCanvases();
watchVisibility();
watchPage(drawCanvases);
document.documentElement.dataset.ready = String(charts.length);
