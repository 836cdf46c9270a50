// Table of the trials, sortable by column.

const textCell = (digits = shown) => content =>
  element('td', {textContent: typeof content === 'string' ? content : digits(content)});
const kTrialColumns = [
  ['axis', row => row.axis, textCell()],
  ['on/off', row => row.state, content => element('td', {textContent: content, className: content})],
  ['policy', row => row.policy || '–', textCell()], ['seed', row => row.seed, textCell(String)],
  ['mean', row => centimetres(row.mean_m), textCell(tenths)],
  ['std. dev.', row => centimetres(row.std_m), textCell(tenths)],
  ['max', row => centimetres(row.max_m), textCell(tenths)]
];

function addTrialTable() {
  byId('trials').hidden = !trialRows.length;
  byId('trials').append(sortableTable(kTrialColumns, trialRows));
}
