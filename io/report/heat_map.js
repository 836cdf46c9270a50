// Heat maps of the displacement in the vertical plane of the moved axis.

const kHeatRamp = ['#0b0724', '#200c4a', '#4a0c6b', '#781c6d', '#a52c60', '#cf4446', '#ed6925', '#fb9b06', '#f7d13d', '#fcffa4'];
const channels = text => [1, 3, 5].map(i => parseInt(text.slice(i, i + 2), 16));

// Colour at a position of the ramp from 0 to 1, linearly interpolated.
function heatColor(share) {
  const at = Math.min(Math.max(share, 0), 1) * (kHeatRamp.length - 1);
  const low = Math.min(Math.floor(at), kHeatRamp.length - 2);
  const [from, to] = [channels(kHeatRamp[low]), channels(kHeatRamp[low + 1])];
  return `rgb(${from.map((value, i) => Math.round(value + (at - low) * (to[i] - value))).join()})`;
}

// Cells in percent; both maps of a set share extent and scale.
function heatOf(axis) {
  const {size_m: size, on, off} = sets[axis].heat;
  const share = Object.fromEntries(Object.entries({on, off}).map(([state, cells]) => {
    const sum = cells.reduce((all, cell) => all + cell[2], 0);
    return [state, cells.map(([across, up, count]) => [across, up, 100 * count / sum])];
  }));
  const all = [...share.on, ...share.off];
  const minSpan = 0.5;
  const span = place => all.reduce(([low, high], cell) =>
    [Math.min(low, (cell[place] - 0.5) * size), Math.max(high, (cell[place] + 0.5) * size)], [-minSpan, minSpan]);
  const [x0, x1] = span(0);
  const [y0, y1] = span(1);
  return {size, share, maxShare: all.reduce((max, cell) => Math.max(max, cell[2]), 0),
          box: {x0: x0 - size, x1: x1 + size, y0: y0 - size, y1: y1 + size}};
}

function drawHeatMap(place) {
  const {axis, state} = place.dataset;
  const {size, share, maxShare, box} = heatOf(axis);
  const plane = fitPlane(place, box, {minHeight: 140, maxHeight: 280});
  const {context, map, scale, width, height} = plane;
  context.fillStyle = heatColor(0);
  context.fillRect(kMargin.left, kMargin.top, width - kMargin.left - kMargin.right, height - kMargin.top - kMargin.bottom);
  for (const [across, up, percent] of share[state]) {
    context.fillStyle = heatColor(Math.sqrt(percent / maxShare));
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

// Colour by the square root of the share, so that rare cells stay visible.
function heatLegend(axis) {
  const {size, maxShare} = heatOf(axis);
  const ramp = element('i');
  ramp.style.background = `linear-gradient(to right, ${kHeatRamp.join()})`;
  const marks = [0, maxShare / 4, maxShare].map(value => element('span', {textContent: `${shown(value, 2)} %`}));
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
