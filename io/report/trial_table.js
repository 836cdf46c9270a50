// Table of the trials, sortable by column.

const kTrialColumns = [
  ['axis', row => row.axis], ['on/off', row => row.state], ['policy', row => row.policy || '–'], ['seed', row => row.seed, String],
  ['mean', row => centimetres(row.mean_m), tenths], ['std. dev.', row => centimetres(row.std_m), tenths],
  ['max', row => centimetres(row.max_m), tenths]
];

// Missing values come last in both orders.
function compareValues(a, b, sign) {
  const missing = value => value === undefined || value === null;
  if (missing(a) || missing(b)) return missing(a) - missing(b);
  return sign * (typeof a === 'number' && typeof b === 'number' ? a - b : String(a).localeCompare(String(b)));
}

function addTrialTable() {
  byId('trials').hidden = !trialRows.length;
  const body = element('tbody');
  const fill = rows => body.replaceChildren(...rows.map(row => element('tr', {}, ...kTrialColumns.map(([, value, digits = shown]) => {
    const content = value(row);
    return element('td', {textContent: typeof content === 'string' ? content : digits(content),
                          className: content === row.state ? row.state : ''});
  }))));
  const heads = kTrialColumns.map(([name, value]) => {
    const head = element('th', {}, element('button', {type: 'button', textContent: name}));
    head.addEventListener('click', () => {
      const upward = head.ariaSort !== 'ascending';
      heads.forEach(other => { other.ariaSort = null; });
      head.ariaSort = upward ? 'ascending' : 'descending';
      fill([...trialRows].sort((a, b) => compareValues(value(a), value(b), upward ? 1 : -1)));
    });
    return head;
  });
  fill(trialRows);
  byId('trials').append(element('div', {className: 'scroll'},
    element('table', {}, element('thead', {}, element('tr', {}, ...heads)), body)));
}
