// Page of a lens calibration.

const corners = decodeAll(data.corners);
const image = summary.image;
const kCells = {columns: 12, rows: 9};

function svg(tag, attributes, ...children) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

const imagePlot = label => svg('svg', {
  class: 'image-plot', role: 'img', 'aria-label': label,
  viewBox: `-0.5 -0.5 ${image.width_px} ${image.height_px}`});

// Index of the cell of each corner, row by row.
function cellOf(i) {
  const column = Math.min(kCells.columns - 1, Math.max(0, Math.floor((corners.x[i] + 0.5) / image.width_px * kCells.columns)));
  const row = Math.min(kCells.rows - 1, Math.max(0, Math.floor((corners.y[i] + 0.5) / image.height_px * kCells.rows)));
  return row * kCells.columns + column;
}

function cellBox(cell) {
  const width = image.width_px / kCells.columns;
  const height = image.height_px / kCells.rows;
  return {x: cell % kCells.columns * width - 0.5, y: Math.floor(cell / kCells.columns) * height - 0.5, width, height};
}

function drawCoverage() {
  const plot = imagePlot('Corners of the board in the image');
  const counts = new Array(kCells.columns * kCells.rows).fill(0);
  for (let i = 0; i < corners.x.length; ++i) ++counts[cellOf(i)];
  const most = Math.max(...counts, 1);
  counts.forEach((count, cell) => {
    if (count) plot.append(svg('rect', {class: 'cell', ...cellBox(cell), 'fill-opacity': 0.08 + 0.4 * count / most}));
  });
  for (const corner of summary.unseen_corners) {
    const [width, height] = [image.width_px / 6, image.height_px / 6];
    plot.append(svg('rect', {class: 'unseen', width, height,
      x: corner.includes('right') ? image.width_px - width : 0, y: corner.includes('lower') ? image.height_px - height : 0}));
  }
  const radius = image.width_px / 320;
  for (let i = 0; i < corners.x.length; ++i) {
    plot.append(svg('circle', {class: 'corner', cx: corners.x[i].toFixed(1), cy: corners.y[i].toFixed(1), r: radius}));
  }
  byId('coverage').append(plot);
}

// A residual of three standard deviations is 1/20 of the image width.
function drawResiduals() {
  const plot = imagePlot('Residuals of the corners');
  const scale = image.width_px / 20 / (3 * Math.max(summary.corner_sigma_px, 1e-6));
  const vector = (kind, x, y, dx, dy) => plot.append(svg('line', {
    class: kind, x1: x.toFixed(1), y1: y.toFixed(1), x2: (x + scale * dx).toFixed(1), y2: (y + scale * dy).toFixed(1),
    'stroke-width': image.width_px / (kind === 'mean' ? 240 : 640), 'stroke-opacity': kind === 'mean' ? 1 : 0.45}));
  const sums = new Map();
  for (let i = 0; i < corners.x.length; ++i) {
    vector('residual', corners.x[i], corners.y[i], corners.dx[i], corners.dy[i]);
    const sum = sums.get(cellOf(i)) || [0, 0, 0];
    sums.set(cellOf(i), [sum[0] + corners.dx[i], sum[1] + corners.dy[i], sum[2] + 1]);
  }
  for (const [cell, [dx, dy, count]] of sums) {
    const box = cellBox(cell);
    if (count > 4) vector('mean', box.x + box.width / 2, box.y + box.height / 2, dx / count, dy / count);
  }
  byId('residual_scale').textContent = `enlarged ${shown(scale, 2)} times; red: mean of a cell`;
  byId('residuals').append(plot);
}

const parameter = name => summary.parameters.find(one => one.name === name) || {};

// Value with as many decimals as its standard deviation has significant ones.
function withSigma(value, sigma) {
  const decimals = Math.min(9, Math.max(0, 1 - Math.floor(Math.log10(sigma || 1))));
  return [value.toFixed(decimals), sigma.toFixed(decimals)];
}

function drawHeadline() {
  const {views} = summary;
  const percent = 100 * parameter('focal_x_px').sigma / parameter('focal_x_px').value;
  byId('headline').append(
    tile('focal length', parameter('focal_x_px').value, 'px', `± ${shown(percent, 2)} %`, 5),
    tile('horizontal field of view', summary.horizontal_fov_deg, 'deg', summary.model),
    tile('lens over the image', summary.lens_sigma_px, 'px, 1 sigma', 'of the parameters', 2),
    tile('corners', summary.corner_sigma_px, 'px, 1 sigma', `${views.selected} views of ${views.different}, found in ${views.found} images`, 2));
  byId('notes').hidden = !summary.unseen_corners.length;
  for (const corner of summary.unseen_corners) {
    byId('notes').firstElementChild.append(element('li', {textContent: `Never seen in the ${corner} of the image: the lens model is extrapolated there.`}));
  }
}

function drawTables() {
  byId('values').append(table(['parameter', 'value', 'sigma'],
    summary.parameters.map(({name, value, sigma}) => [name, ...withSigma(value, sigma)])));
  const models = table(['model', 'parameters', 'RMS, px'],
    summary.models.map(one => [one.name, one.parameters, one.held_out_rms_px.toFixed(4)]));
  summary.models.forEach((one, i) => {
    if (one.selected) models.querySelectorAll('tbody tr')[i].className = 'selected';
  });
  byId('models').append(models);
  byId('views').append(table(['image', 'time, s', 'corners', 'tilt, deg', 'RMS, px'],
    summary.selected.map(view => [String(view.frame), view.t_s.toFixed(2), view.corners, view.tilt_deg.toFixed(0), view.rms_px.toFixed(3)])));
}

byId('subtitle').textContent = `stillkite calibrate · ${image.width_px} x ${image.height_px} px`;
drawHeadline();
drawCoverage();
drawResiduals();
drawTables();
document.documentElement.dataset.ready = String(corners.x.length);
