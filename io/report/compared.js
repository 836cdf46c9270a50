// Estimators of this page; columns are named "INDEX NAME".

const runs = data.runs || [];
const truth = data.truth;
const lengthUnit = data.length_unit;
const speedUnit = `${lengthUnit}/s`;
const runColor = i => `run_${i % 8}`;
const columns = {};
runs.forEach((run, i) => {
  for (const [name, values] of Object.entries(run.columns)) columns[`${i} ${name}`] = decode(values);
});
for (const [name, values] of Object.entries(truth ? truth.columns : {})) columns[`true ${name}`] = decode(values);
const time = data.time_s ? decode(data.time_s) : new Float32Array();
const duration = time.length ? time[time.length - 1] : 0;

const decodePath = (of, look) => ({x: decode(of.path.x), y: decode(of.path.y), ...look});
const pathTime = data.path_time_s ? decode(data.path_time_s) : new Float32Array();
const paths = [
  ...(truth ? [decodePath(truth, {color: 'truth', width: 5})] : []),
  ...runs.flatMap((run, i) => run.path ? [decodePath(run, {color: runColor(i), width: 1.6, end: runColor(i)})] : [])];

// One line per estimator, on top of the truth.
const compared = column => [
  {label: 'truth', column: `true ${column}`, color: 'truth', width: 5},
  ...runs.map((run, i) => ({label: `estimator ${i}`, column: `${i} ${column}`, color: runColor(i), width: 1.3}))];
