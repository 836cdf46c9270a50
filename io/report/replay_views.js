// One instant of a trial, from above and from the side.

// Of a view its two axes and what grows to the right and up: from above the paper's z points down.
const kTopView = {across: 'x', up: 'z', sign: -1};
const sideView = trial => ({across: sets[trial.axis].across, up: 'y', sign: 1});

function linesOf(trial, view) {
  const line = (body, colorName, width) => ({x: trial.replay[`${body}_${view.across}`],
    y: trial.replay[`${body}_${view.up}`].map(value => view.sign * value), color: colorName, width});
  return {station: line('station', 'way', 3), drone: line('drone', trial.state, 1.8), all: line('drone', 'path', 1.4)};
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

// Where the drone has to stay.
function drawHome(context, [x, y]) {
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
                         place.clientWidth < 420 ? {least: 150, most: 190} : {least: 250, most: 320});
  const {context, map} = plane;
  drawGrid(plane, {x: `${view.across}, m`, y: `${view.up}, m`, down: view.sign < 0});
  const at = (line, i) => [map.x(line.x[i]), map.y(line.y[i])];
  drawLine(context, lines.station, map, 0, count);
  drawLine(context, lines.all, map, 0, count);
  drawLine(context, lines.drone, map, 0, index + 1);
  drawHome(context, at(lines.drone, 0));
  const [station, drone] = [at(lines.station, index), at(lines.drone, index)];
  if ([...station, ...drone].some(Number.isNaN)) return;
  drawTether(context, station, drone);
  drawStation(context, station);
  dot(context, ...drone, color(trial.state), 6);
}

function drawReplayKeys(trial) {
  byId('replay_keys').replaceChildren();
  addKeys(byId('replay_keys'), [['drone and its trail', trial.state], ['place to hold', 'start', 'ring'],
    ['station', 'station', 'band'], ['station\'s way', 'way', 'thick'], ['tether', 'ink']]);
}
