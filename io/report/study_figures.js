// Card of each metric: statistics per group, and the values of its jobs on a common axis.

const jobs = summary.jobs || [];
const groups = summary.groups || [];
const metrics = summary.metrics || [];

const groupLabel = group =>
  [group.flight_group, group.configuration, group.estimator].filter(Boolean).join(', ') || 'all';
const link = (href, text) => href ? element('a', {href: encodeURI(href), textContent: text}) : text;

// Dotted path that breaks at its dots.
function pathText(path) {
  return path.split('.').flatMap((part, i) => i ? ['.', element('wbr'), part] : [part]);
}

function jobsOf(group) {
  return jobs.filter(job => job.configuration === group.configuration && job.estimator === group.estimator &&
    (!group.flight_group || job.flight_group === group.flight_group));
}

function svg(tag, attributes) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
}

// Axis over the values: logarithmic if all are positive and span more than a factor of 30, else linear,
// from 0 unless this hides their differences.
function axisOf(values) {
  const low = Math.min(...values);
  const high = Math.max(...values);
  const isLogarithmic = low > 0 && high > 30 * low;
  const from = isLogarithmic || low > high / 2 ? low : Math.min(low, 0);
  const scale = value => isLogarithmic ? Math.log(value) : value;
  const span = scale(high) - scale(from) || 1;
  return {from, to: high, isLogarithmic, percent: value => `${1 + 98 * (scale(value) - scale(from)) / span}%`};
}

function drawValues(group, figure, found, axis) {
  const plot = svg('svg', {role: 'img'});
  const line = (from, to, name, top, bottom) => plot.append(svg('line',
    {x1: axis.percent(from), x2: axis.percent(to), y1: top, y2: bottom, class: name}));
  if (typeof found.low === 'number') line(found.low, found.high, 'interval', 13, 13);
  for (const job of jobsOf(group)) {
    const value = job.figures[figure];
    if (typeof value !== 'number') continue;
    const point = svg('circle', {cx: axis.percent(value), cy: 13, r: 4, class: 'value'});
    point.append(svg('title', {}));
    point.firstChild.textContent = `${job.id}: ${shown(value)}`;
    plot.append(point);
  }
  line(found.median, found.median, 'median', 4, 22);
  return plot;
}

function groupRow(group, metric, axis) {
  const found = group.figures[metric.figure];
  const count = element('td', {textContent: `${found.samples}/${group.jobs}`,
                               className: found.samples < group.jobs ? 'incomplete' : ''});
  const cell = content => element('td', {}, content);
  const row = element('tr', {}, cell(groupLabel(group)), count);
  if (!found.samples) {
    row.append(element('td', {colSpan: 5}));
    return row;
  }
  const interval = typeof found.low === 'number' ? `${shown(found.low)} … ${shown(found.high)}` : '–';
  row.append(cell(shown(found.median)), cell(interval), cell(shown(found.nine_in_ten)),
             element('td', {title: found.worst_job}, link(found.worst_results, shown(found.worst))),
             element('td', {}, drawValues(group, metric.figure, found, axis)));
  return row;
}

function metricCard(metric) {
  const values = jobs.map(job => job.figures[metric.figure]).filter(value => typeof value === 'number');
  const note = metric.worst === 'lowest' ? [element('small', {textContent: 'worst: lowest'})] : [];
  const card = element('section', {className: 'card metric'}, element('h2', {}, ...pathText(metric.figure), ...note));
  if (!values.length) {
    card.append(element('p', {className: 'lead', textContent: 'No job has this figure.'}));
    return card;
  }
  const axis = axisOf(values);
  const scale = element('div', {className: 'scale'}, element('span', {textContent: shown(axis.from)}),
                        element('span', {textContent: axis.isLogarithmic ? 'logarithmic' : ''}),
                        element('span', {textContent: shown(axis.to)}));
  const heads = ['', 'jobs', 'median', '95 % interval', '9 in 10', 'worst', scale];
  card.append(element('div', {className: 'scroll'}, element('table', {},
    element('thead', {}, element('tr', {}, ...heads.map(head => element('th', {}, head)))),
    element('tbody', {}, ...groups.map(group => groupRow(group, metric, axis))))));
  return card;
}
