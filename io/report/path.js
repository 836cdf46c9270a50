// The path seen from above, with equal axes; it follows the charts' zoom and pointer.

const kMargin = {left: 46, right: 14, top: 10, bottom: 26};

function niceStep(range, count) {
  const rough = range / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find(factor => factor * power >= rough);
}

// Extent of what is shown, padded, never empty.
function extent(lines, from, to) {
  const box = {x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity};
  for (const {x, y} of lines) {
    for (let i = from; i < to; ++i) {
      if (Number.isNaN(x[i]) || Number.isNaN(y[i])) continue;
      box.x0 = Math.min(box.x0, x[i]); box.x1 = Math.max(box.x1, x[i]);
      box.y0 = Math.min(box.y0, y[i]); box.y1 = Math.max(box.y1, y[i]);
    }
  }
  if (!Number.isFinite(box.x0)) return {x0: -1, x1: 1, y0: -1, y1: 1};
  const pad = 0.06 * Math.max(box.x1 - box.x0, box.y1 - box.y0) || 0.05;
  return {x0: box.x0 - pad, x1: box.x1 + pad, y0: box.y0 - pad, y1: box.y1 + pad};
}

function pathLines() {
  const lines = [];
  if (path.position_true_x_m) {
    lines.push({x: path.position_true_x_m, y: path.position_true_y_m, color: 'truth', width: 4});
  }
  lines.push({x: path.position_x_m, y: path.position_y_m, color: 'estimate', width: 1.6});
  return lines;
}

function drawGrid(context, box, map, scale, height, width) {
  const step = niceStep(70 / scale, 1);
  context.font = '11px system-ui, sans-serif';
  context.strokeStyle = color('grid');
  context.fillStyle = color('soft');
  context.lineWidth = 1;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (let x = Math.ceil(box.x0 / step) * step; x <= box.x1; x += step) {
    context.beginPath(); context.moveTo(map.x(x), kMargin.top); context.lineTo(map.x(x), height - kMargin.bottom); context.stroke();
    context.fillText(shown(Math.abs(x) < step / 1e6 ? 0 : x), map.x(x), height - kMargin.bottom + 6);
  }
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (let y = Math.ceil(box.y0 / step) * step; y <= box.y1; y += step) {
    context.beginPath(); context.moveTo(kMargin.left, map.y(y)); context.lineTo(width - kMargin.right, map.y(y)); context.stroke();
    context.fillText(shown(Math.abs(y) < step / 1e6 ? 0 : y), kMargin.left - 6, map.y(y));
  }
  context.textAlign = 'left';
  context.textBaseline = 'top';
  context.fillText(`y, ${lengthUnit}`, 2, 0);
  context.textAlign = 'right';
  context.textBaseline = 'bottom';
  context.fillText(`x, ${lengthUnit}`, width - kMargin.right, height - kMargin.bottom - 3);
}

function drawLine(context, line, map, from, to) {
  context.strokeStyle = color(line.color);
  context.lineWidth = line.width;
  context.lineJoin = 'round';
  context.beginPath();
  let open = false;
  for (let i = from; i < to; ++i) {
    if (Number.isNaN(line.x[i]) || Number.isNaN(line.y[i])) { open = false; continue; }
    if (open) context.lineTo(map.x(line.x[i]), map.y(line.y[i]));
    else context.moveTo(map.x(line.x[i]), map.y(line.y[i]));
    open = true;
  }
  context.stroke();
}

function dot(context, x, y, fill, radius = 5) {
  if (Number.isNaN(x) || Number.isNaN(y)) return;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = color('card');
  context.stroke();
}

function drawPath() {
  const place = document.querySelector('.top-view');
  if (!path.position_x_m) return;
  const lines = pathLines();
  const n = path.time_s.length;
  let from = 0;
  let to = n;
  if (timeWindow) {
    from = Math.max(0, path.time_s.findIndex(t => t >= timeWindow[0]));
    const end = path.time_s.findIndex(t => t > timeWindow[1]);
    to = end < 0 ? n : Math.max(end, from + 2);
  }
  const box = extent(lines, from, to);
  const inner = place.clientWidth - kMargin.left - kMargin.right;
  const wanted = inner * (box.y1 - box.y0) / (box.x1 - box.x0);
  const height = Math.min(Math.max(wanted, 170), 430) + kMargin.top + kMargin.bottom;
  const {context, width} = fitCanvas(place, height);
  const scale = Math.min(inner / (box.x1 - box.x0), (height - kMargin.top - kMargin.bottom) / (box.y1 - box.y0));

  // Equal axes: what is left over is shared out on both sides.
  const spareX = inner / scale - (box.x1 - box.x0);
  const spareY = (height - kMargin.top - kMargin.bottom) / scale - (box.y1 - box.y0);
  const view = {x0: box.x0 - spareX / 2, x1: box.x1 + spareX / 2, y0: box.y0 - spareY / 2, y1: box.y1 + spareY / 2};
  const map = {x: x => kMargin.left + (x - view.x0) * scale, y: y => height - kMargin.bottom - (y - view.y0) * scale};
  drawGrid(context, view, map, scale, height, width);
  for (const line of lines) drawLine(context, line, map, from, to);
  const estimate = lines[lines.length - 1];
  const mark = (i, fill, radius) => dot(context, map.x(estimate.x[i]), map.y(estimate.y[i]), fill, radius);
  mark(from, color('start'));
  mark(to - 1, color('end'));
  if (pointed !== null) mark(Math.round(pointed * (n - 1) / Math.max(time.length - 1, 1)), color('ink'), 6);
}

windowListeners.push(drawPath);
pointListeners.push(drawPath);
