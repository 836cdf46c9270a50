// Tables of comparison.json.

const degrees = value => typeof value === 'number' ? value * 180 / Math.PI : undefined;
const identity = value => value;
const percent = value => typeof value === 'number' ? 100 * value : undefined;
const norm = axes => Array.isArray(axes) ? Math.hypot(...axes) : undefined;
const frameFigures = {
  position_m: ['position, m', identity], velocity_m_s: ['velocity, m/s', identity],
  attitude_rad: ['attitude, °', degrees], angular_rate_rad_s: ['angular rate, °/s', degrees]};

// [label, path in an estimator's entry, conversion, figure of `differences`]
const resultGroups = [
  ['Error over the flight', [
    ['position RMSE, m', 'evaluation.position_rmse_m', identity],
    ['drift, % of the path', 'evaluation.drift_percent', identity],
    ['velocity RMSE, m/s', 'evaluation.velocity_rmse_m_s', norm],
    ['tilt RMSE, °', 'evaluation.tilt_rmse_rad', degrees],
    ['yaw RMSE, °', 'evaluation.yaw_rmse_rad', degrees]]],
  ['Relative to the reference', [
    ['rotation, median, °', 'evaluation.reference.rotation_median_deg', identity],
    ['direction, median, °', 'evaluation.reference.direction_median_deg', identity],
    ['frames with a direction', 'evaluation.reference.directions', identity],
    ['displacement RMSE, m', 'evaluation.reference.displacement_rmse_m', identity]]],
  ['Mean error per frame', Object.entries(frameFigures).map(
    ([figure, [label, shownAs]]) => [label, `mean_error.${figure}`, shownAs, figure])],
  ['Availability and time', [
    ['frames with an estimate, %', 'availability_ratio', percent],
    ['median, ms per frame', 'timing.frame_ms.median', identity],
    ['99th percentile, ms per frame', 'timing.frame_ms.p99', identity]]]];

const entries = summary.estimators || [];
const lookUp = (entry, path) => path.split('.').reduce((at, key) => at === null || at === undefined ? at : at[key], entry);
const differences = summary.differences || [];
const verdictLabels = {not_significant: 'n.s.'};

function runSwatch(i) {
  const swatch = element('span', {className: 'swatch run'});
  swatch.style.background = `var(--${runColor(i)})`;
  return swatch;
}

function badge(entry, figure) {
  const found = differences.find(d => d.of === entry.name && d.against === entries[0].name && d.figure === figure);
  return element('span', {className: `badge ${found ? found.verdict : ''}`,
                          textContent: found ? verdictLabels[found.verdict] || found.verdict : ''});
}

function resultRow([label, path, shownAs, figure]) {
  const values = entries.map(entry => shownAs(lookUp(entry, path)));
  if (values.every(value => typeof value !== 'number')) return null;
  return element('tr', {}, element('td', {textContent: label}), ...values.map((value, i) =>
    element('td', {}, shown(value), ...(differences.length ? [badge(entries[i], figure)] : []))));
}

function drawResult() {
  if (!entries.length) return;
  const heads = entries.map((entry, i) => {
    return element('th', {title: (entry.keys || []).join('\n')}, runSwatch(i),
                   element('a', {href: `${encodeURIComponent(entry.name)}/report.html`, textContent: entry.name}),
                   ...(differences.length ? [element('span', {className: 'badge'})] : []));
  });
  const body = element('tbody');
  for (const [group, figures] of resultGroups) {
    const rows = figures.map(resultRow).filter(row => row);
    if (!rows.length) continue;
    body.append(element('tr', {className: 'group'}, element('td', {colSpan: 1 + entries.length, textContent: group})), ...rows);
  }
  const head = element('thead', {}, element('tr', {}, element('th'), ...heads));
  byId('result').append(element('div', {className: 'scroll'}, element('table', {}, head, body)));
  if (differences.length) {
    byId('result').append(element('p', {className: 'lead note',
      textContent: `Better, worse: significant difference to ${entries[0].name} on common frames (95 %); n.s.: not significant; ` +
        'drifting: correlation time too long for a significant result from one flight.'}));
  }
}

function drawDifferences() {
  byId('differences').hidden = !differences.length;
  const rows = differences.map(({of, against, figure, mean, low, high, verdict}) => {
    const [label, shownAs] = frameFigures[figure] || [figure, identity];
    return [`${of} − ${against}`, label, shownAs(mean), `${shown(shownAs(low))} … ${shown(shownAs(high))}`,
            verdict.replaceAll('_', ' ')];
  });
  if (rows.length) byId('differences').append(table(['', 'error', 'mean', '95 % confidence interval', 'verdict'], rows));
}

function drawSubtitle() {
  const timing = summary.timing || {};
  byId('subtitle').textContent = [`${shown(duration)} s`, `${summary.frames_read ?? '–'} frames`,
    `${shown(timing.wall_s)} s in total, decoding ${shown(timing.decoding_s)} s in parallel`,
    timing.threads === 1 ? 'one thread per estimator' : `${timing.threads ?? '–'} threads per estimator`,
    ...runs.filter(run => !run.is_metric && lengthUnit === 'm').map(run => `${run.name} has no scale: no lengths`),
    summary.interrupted ? 'interrupted' : '',
    data.decimated ? 'charts show minimum and maximum per interval' : '']
    .filter(Boolean).join(' · ');
  byId('summary').textContent = JSON.stringify(summary, null, 2);
}
