// Where the drone was about the place to hold, in the upright plane of the moved axis.

const kHeatRamp = ['#0b0724', '#200c4a', '#4a0c6b', '#781c6d', '#a52c60', '#cf4446', '#ed6925', '#fb9b06', '#f7d13d', '#fcffa4'];
const channels = text => [1, 3, 5].map(i => parseInt(text.slice(i, i + 2), 16));

// Of a share of the ramp from 0 to 1, between its two neighbours.
function heatColor(share) {
  const at = Math.min(Math.max(share, 0), 1) * (kHeatRamp.length - 1);
  const low = Math.min(Math.floor(at), kHeatRamp.length - 2);
  const [from, to] = [channels(kHeatRamp[low]), channels(kHeatRamp[low + 1])];
  return `rgb(${from.map((value, i) => Math.round(value + (at - low) * (to[i] - value))).join()})`;
}

// Both maps of a set have the same extent and the same scale.
function heatOf(axis) {
  const {size_m: size, on, off} = sets[axis].heat;
  const share = Object.fromEntries(Object.entries({on, off}).map(([state, cells]) => {
    const sum = cells.reduce((all, cell) => all + cell[2], 0);
    return [state, cells.map(([across, up, count]) => [across, up, 100 * count / sum])];
  }));
  const all = [...share.on, ...share.off];
  const least = 0.5;
  const span = place => all.reduce(([low, high], cell) =>
    [Math.min(low, (cell[place] - 0.5) * size), Math.max(high, (cell[place] + 0.5) * size)], [-least, least]);
  const [x0, x1] = span(0);
  const [y0, y1] = span(1);
  return {size, share, greatest: all.reduce((most, cell) => Math.max(most, cell[2]), 0),
          box: {x0: x0 - size, x1: x1 + size, y0: y0 - size, y1: y1 + size}};
}

function drawHeatMap(place) {
  const {axis, state} = place.dataset;
  const {size, share, greatest, box} = heatOf(axis);
  const plane = fitPlane(place, box, {least: 140, most: 280});
  const {context, map, scale, width, height} = plane;
  context.fillStyle = heatColor(0);
  context.fillRect(kMargin.left, kMargin.top, width - kMargin.left - kMargin.right, height - kMargin.top - kMargin.bottom);
  for (const [across, up, percent] of share[state]) {
    context.fillStyle = heatColor(Math.sqrt(percent / greatest));
    context.fillRect(map.x((across - 0.5) * size), map.y((up + 0.5) * size), size * scale + 0.3, size * scale + 0.3);
  }
  drawGrid(plane, {x: `${sets[axis].across}, m`, y: 'y, m'},
           {line: 'rgba(255, 255, 255, 0.13)', inside: 'rgba(255, 255, 255, 0.8)'});
  context.strokeStyle = 'rgba(255, 255, 255, 0.9)';
  context.lineWidth = 1.2;
  for (const [dx, dy] of [[7, 0], [0, 7]]) {
    context.beginPath();
    context.moveTo(map.x(0) - dx, map.y(0) - dy);
    context.lineTo(map.x(0) + dx, map.y(0) + dy);
    context.stroke();
  }
}

// The root of the share is what is coloured: rare places stay visible beside the most frequent.
function heatLegend(axis) {
  const {size, greatest} = heatOf(axis);
  const ramp = element('i');
  ramp.style.background = `linear-gradient(to right, ${kHeatRamp.join()})`;
  const marks = [0, greatest / 4, greatest].map(value => element('span', {textContent: `${shown(value, 2)} %`}));
  return element('div', {className: 'ramp'}, element('span', {className: 'scale'}, ramp,
    element('span', {className: 'marks'}, ...marks)), `of the frames in a cell of ${shown(100 * size)} cm`);
}

function addHeatMaps() {
  for (const axis of flownAxes) {
    const {on, off} = sets[axis].heat;
    if (!on.length && !off.length) continue;
    const maps = [['on', on], ['off', off]].filter(([, cells]) => cells.length).map(([state]) => {
      const place = element('div', {className: 'heat'});
      Object.assign(place.dataset, {axis, state});
      return element('figure', {}, element('figcaption', {}, `station moved along ${axis}, stabilization `,
        element('b', {className: state, textContent: state})), place);
    });
    byId('heat_maps').append(element('div', {className: 'heat-row'},
      element('div', {className: 'pair'}, ...maps), heatLegend(axis)));
  }
}

const drawHeatMaps = () => document.querySelectorAll('.heat').forEach(drawHeatMap);
