// Table whose rows are sorted by a click on a column header.

// Missing values come last in both orders.
function compareValues(a, b, sign) {
  const missing = value => value === undefined || value === null;
  if (missing(a) || missing(b)) return missing(a) - missing(b);
  return sign * (typeof a === 'number' && typeof b === 'number' ? a - b : String(a).localeCompare(String(b)));
}

// columns: [heading, value of a row, content of the cell from value and row]
function sortableTable(columns, rows) {
  const body = element('tbody');
  const fill = sorted => body.replaceChildren(...sorted.map(row => element('tr', {},
    ...columns.map(([, value, cell]) => cell(value(row), row)))));
  const heads = columns.map(([name, value]) => {
    const head = element('th', {}, element('button', {type: 'button'}, name));
    head.addEventListener('click', () => {
      const upward = head.ariaSort !== 'ascending';
      heads.forEach(other => { other.ariaSort = null; });
      head.ariaSort = upward ? 'ascending' : 'descending';
      fill([...rows].sort((a, b) => compareValues(value(a), value(b), upward ? 1 : -1)));
    });
    return head;
  });
  fill(rows);
  return element('div', {className: 'scroll'},
    element('table', {}, element('thead', {}, element('tr', {}, ...heads)), body));
}
