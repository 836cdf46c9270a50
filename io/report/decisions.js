// Controller decisions: texts, colours and shares of time.

const kReasons = {
  none: 'position and yaw are controlled',
  no_estimate: 'no estimate yet',
  estimate_lost: 'no measurement by the estimator',
  estimate_gated: 'measurement rejected by the gate',
  estimate_stale: 'estimate too old',
  not_finite: 'non-finite input',
  no_tether_reading: 'no tether reading yet',
  tether_stale: 'tether reading too old',
  tether_slack: 'tether slack',
  tether_out_of_range: 'tether reading out of range',
  angle_first: 'rotation is corrected before translation',
  displacement_unknown: 'displacement from the reference unknown',
  within_dead_band: 'error within the dead band'
};
const kDecisionColors = {
  'command none': '#2a9d74', 'command angle_first': '#e69f00', 'command displacement_unknown': '#56b4e9',
  'hold within_dead_band': '#a9b4c1', 'hold angle_first': '#b07d12', 'hold displacement_unknown': '#4059ad',
  'hold estimate_gated': '#cc79a7', 'hold estimate_lost': '#c1121f', 'hold estimate_stale': '#d55e00',
  'hold no_estimate': '#6c757d'
};
const kOtherColors = ['#8e5bd0', '#9c6644', '#00a5b5', '#b5179e', '#7a8b00', '#344e41'];

const decisionColor = index => kDecisionColors[data.decisions[index].join(' ')] || kOtherColors[index % kOtherColors.length];

function decisionWords(index) {
  const [action, reason] = data.decisions[index];
  const why = Object.hasOwn(kReasons, reason) ? kReasons[reason] : reason.replaceAll('_', ' ');
  return why ? `${action}: ${why}` : action;
}

const sum = values => values.reduce((all, value) => all + value, 0);

function decisionBar(name, counts) {
  const total = sum(counts);
  const parts = counts.map((count, index) => [index, count]).filter(([, count]) => count > 0).map(([index, count]) => {
    const part = element('i', {title: `${decisionWords(index)}: ${shown(100 * count / total, 3)} %`});
    part.style.width = `${100 * count / total}%`;
    part.style.background = decisionColor(index);
    return part;
  });
  return element('div', {className: 'share'}, element('span', {textContent: name}), element('div', {className: 'bar'}, ...parts));
}

function drawDecisions() {
  const axes = flownAxes.filter(axis => sum(sets[axis].decisions) > 0);
  byId('decisions').hidden = !axes.length;
  if (!axes.length) return;
  const all = data.decisions.map((_, index) => sum(axes.map(axis => sets[axis].decisions[index])));
  const legend = data.decisions.map((_, index) => index).sort((a, b) => all[b] - all[a]).map(index => {
    const swatch = element('span', {className: 'swatch'});
    swatch.style.background = decisionColor(index);
    return element('li', {}, swatch, `${decisionWords(index)} `,
                   element('b', {textContent: `${shown(100 * all[index] / sum(all), 3)} %`}));
  });
  byId('decisions').append(...axes.map(axis => decisionBar(axis, sets[axis].decisions)), decisionBar('all', all),
                           element('ul', {className: 'legend'}, ...legend));
}
