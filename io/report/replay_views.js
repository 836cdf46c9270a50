// Top view and side view of a trial at one time.

// Axes of a view and the sign of the vertical one; in the top view the paper's z points down.
const kTopView = {across: 'x', up: 'z', sign: -1};
const sideView = trial => ({across: sets[trial.axis].across, up: 'y', sign: 1});

function linesOf(trial, view) {
  const line = (body, colorName, width) => ({x: trial.replay[`${body}_${view.across}`],
    y: trial.replay[`${body}_${view.up}`].map(value => view.sign * value), color: colorName, width});
  return {station: line('station', 'station_path', 3), drone: line('drone', trial.state, 1.8), all: line('drone', 'path', 1.4)};
}

function drawTether(context, from, to) {
  context.strokeStyle = color('ink');
  context.lineWidth = 1.2;
  context.beginPath();
  context.moveTo(...from);
  context.lineTo(...to);
  context.stroke();
}

function drawStation(context, [x, y]) {
  context.fillStyle = color('station');
  context.fillRect(x - 9, y - 6, 18, 12);
}

// Reference position.
function drawReference(context, [x, y]) {
  context.strokeStyle = color('start');
  context.lineWidth = 2;
  context.beginPath();
  context.arc(x, y, 9, 0, 2 * Math.PI);
  context.stroke();
}

function drawReplayView(place, trial, view, index) {
  const lines = linesOf(trial, view);
  const count = trial.replay.time_s.length;
  const box = extent([lines.station, lines.drone], 0, count);
  if (view.up === 'y') box.y0 = Math.min(box.y0, 0);
  const plane = fitPlane(place, {x0: box.x0 - 0.25, x1: box.x1 + 0.25, y0: box.y0 - 0.25, y1: box.y1 + 0.25},
                         place.clientWidth < 420 ? {minHeight: 150, maxHeight: 190} : {minHeight: 250, maxHeight: 320});
  const {context, map} = plane;
  drawGrid(plane, {x: `${view.across}, m`, y: `${view.up}, m`, down: view.sign < 0});
  const at = (line, i) => [map.x(line.x[i]), map.y(line.y[i])];
  drawLine(context, lines.station, map, 0, count);
  drawLine(context, lines.all, map, 0, count);
  drawLine(context, lines.drone, map, 0, index + 1);
  drawReference(context, at(lines.drone, 0));
  const [station, drone] = [at(lines.station, index), at(lines.drone, index)];
  if ([...station, ...drone].some(Number.isNaN)) return;
  drawTether(context, station, drone);
  drawStation(context, station);
  dot(context, ...drone, color(trial.state), 6);
}

function drawReplayKeys(trial) {
  byId('replay_keys').replaceChildren();
  addKeys(byId('replay_keys'), [['drone and its path', trial.state], ['reference position', 'start', 'ring'],
    ['station', 'station', 'band'], ['station path', 'station_path', 'thick'], ['tether', 'ink']]);
}
