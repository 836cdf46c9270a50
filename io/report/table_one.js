// Table I of the hold paper next to this run's, in cm, and the key figures.

const kPaperTable = {
  on: {mean_m: {x: 36, y: 26, z: 35, all: 34}, std_m: {x: 45, y: 31, z: 43, all: 42}},
  off: {mean_m: {x: 106, y: 43, z: 108, all: 98}, std_m: {x: 122, y: 52, z: 119, all: 118}}
};

const ours = (state, axis, figure) => centimetres((((summary.table || {})[state] || {})[axis] || {})[figure]);

function drawTableOne() {
  const columnNames = [...kAxes, 'all'];
  const cell = (state, axis, figure) => {
    const papers = (kPaperTable[state][figure] || {})[axis];
    return element('td', {}, element('b', {className: 'ours', textContent: tenths(ours(state, axis, figure))}),
      ...(papers ? [element('span', {className: 'papers', textContent: ` / ${papers}`})] : []));
  };
  const row = (state, figure, name, first) => element('tr', {className: first ? 'first' : ''},
    element('td', {}, element('span', {className: state, textContent: state}), ` ${name}`),
    ...columnNames.map(axis => cell(state, axis, figure)));
  const rows = ['on', 'off'].flatMap(state => [
    row(state, 'mean_m', 'mean', true), row(state, 'std_m', 'std. dev.'), row(state, 'max_m', 'max')]);
  byId('table_one').append(element('div', {className: 'scroll'}, element('table', {},
    element('thead', {}, element('tr', {}, ...['stabilization', ...columnNames.map(axis => axis === 'all' ? 'all' : `${axis}-axis`)]
      .map(name => element('th', {textContent: name})))),
    element('tbody', {}, ...rows))));
}

function describeRun() {
  const seconds = axis => shown(Math.max(...trialsOf(axis).map(durationOf)), 2);
  const flown = trials.filter(trial => trial.stabilized);
  const policies = [...new Set(flown.map(trial => trial.policy))].filter(Boolean);
  return [
    `${trials.length} simulated trials: ${flown.length} with stabilization, ${trials.length - flown.length} without`,
    policies.length ? `estimator ${policies.join(', ')}` : '',
    flownAxes.length ? `station moved along ${flownAxes.map(axis => `${axis} (${seconds(axis)} s)`).join(', ')}` : ''
  ].filter(Boolean).join(' · ');
}

function drawHeadline() {
  const on = ours('on', 'all', 'mean_m');
  const off = ours('off', 'all', 'mean_m');
  const paper = {on: kPaperTable.on.mean_m.all, off: kPaperTable.off.mean_m.all};
  byId('headline').append(
    tile('Mean displacement, on', on, 'cm', `hold paper: ${paper.on} cm`, 3),
    tile('Mean displacement, off', off, 'cm', `hold paper: ${paper.off} cm`, 3),
    tile('Ratio off / on', on > 0 ? off / on : undefined, '×', `hold paper: ${shown(paper.off / paper.on, 2)} ×`, 3),
    tile('Simulation', (summary.timing || {}).real_time_factor, '× real time', 'all trials', 3));
  byId('subtitle').textContent = describeRun();
  byId('summary').textContent = JSON.stringify(summary, null, 2);
}
