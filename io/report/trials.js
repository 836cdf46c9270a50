// Trials of this page. Axes of the hold paper: x and z horizontal, y up.

const kAxes = ['x', 'y', 'z'];
const trials = data.trials.map(trial => ({...trial, state: trial.stabilized ? 'on' : 'off',
  chart: decodeAll(trial.chart), replay: decodeAll(trial.replay)}));
const sets = data.sets;
const trialsOf = axis => trials.filter(trial => trial.axis === axis);
const flownAxes = kAxes.filter(axis => trialsOf(axis).length);
const durationOf = trial => trial.replay.time_s.length ? trial.replay.time_s[trial.replay.time_s.length - 1] : 0;

const centimetres = value => typeof value === 'number' ? 100 * value : undefined;

// One decimal, without a negative zero.
const tenths = value => Number.isFinite(value) ? (Math.round(10 * value) / 10 || 0).toFixed(1) : '–';

// Rows of summary.json.
const isOn = row => row.stabilization === 'on' || row.stabilization === true;
const trialRows = (summary.trials || []).map(row => ({...row, state: isOn(row) ? 'on' : 'off'}));
const rowOf = trial => trialRows.find(row => row.axis === trial.axis && row.state === trial.state &&
  row.policy === trial.policy && row.seed === trial.seed) || {};

const stateKeys = [['stabilization on', 'on'], ['off', 'off', 'thick']];
