// Tiles and tables.

function tile(name, value, unit, note, digits = 4) {
  const number = element('div', {className: 'value'}, shown(value, digits), ' ',
                         element('span', {className: 'unit', textContent: unit}));
  const parts = [element('div', {className: 'name', textContent: name}), number];
  if (note) parts.push(element('div', {className: 'note', textContent: note}));
  return element('div', {className: 'tile'}, ...parts);
}

function table(head, rows) {
  const cells = (tag, values) => element('tr', {}, ...values.map(
    value => element(tag, {textContent: typeof value === 'string' ? value : shown(value, 4)})));
  const body = element('table', {}, element('thead', {}, cells('th', head)),
                       element('tbody', {}, ...rows.map(row => cells('td', row))));
  return element('div', {className: 'scroll'}, body);
}
