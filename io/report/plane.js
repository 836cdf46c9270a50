// 2-D plots with equal axes.

const kMargin = {left: 46, right: 14, top: 10, bottom: 26};

function niceStep(range, count) {
  const rough = range / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find(factor => factor * power >= rough);
}

// Bounding box of the lines, padded, never empty.
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

// Second argument: names of the axes with units; `down`: the vertical axis is positive downwards.
function drawGrid({context, view, map, scale, height, width}, {x: nameX, y: nameY, down = false},
                  {line = color('grid'), inside = color('soft')} = {}) {
  const stepX = niceStep(70 / scale, 1);
  const stepY = niceStep(Math.min(70 / scale, (view.y1 - view.y0) / 4), 1);  // finer for a flat view
  const marked = value => shown(Math.abs(value) < stepY / 1e6 ? 0 : value);
  context.font = '11px system-ui, sans-serif';
  context.strokeStyle = line;
  context.fillStyle = color('soft');
  context.lineWidth = 1;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (let x = Math.ceil(view.x0 / stepX) * stepX; x <= view.x1; x += stepX) {
    context.beginPath(); context.moveTo(map.x(x), kMargin.top); context.lineTo(map.x(x), height - kMargin.bottom); context.stroke();
    context.fillText(marked(x), map.x(x), height - kMargin.bottom + 6);
  }
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (let y = Math.ceil(view.y0 / stepY) * stepY; y <= view.y1; y += stepY) {
    context.beginPath(); context.moveTo(kMargin.left, map.y(y)); context.lineTo(width - kMargin.right, map.y(y)); context.stroke();
    if (map.y(y) > 18) context.fillText(marked(down ? -y : y), kMargin.left - 6, map.y(y));  // keeps the axis name clear
  }
  context.textAlign = 'left';
  context.textBaseline = 'top';
  context.fillText(nameY, 2, 0);
  context.fillStyle = inside;
  context.textAlign = 'right';
  context.textBaseline = 'bottom';
  context.fillText(nameX, width - kMargin.right - 4, height - kMargin.bottom - 3);
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

// Canvas over the box with equal axes; spare space is distributed to both sides.
function fitPlane(place, box, {minHeight = 170, maxHeight = 430} = {}) {
  const inner = place.clientWidth - kMargin.left - kMargin.right;
  const wanted = inner * (box.y1 - box.y0) / (box.x1 - box.x0);
  const innerHeight = Math.min(Math.max(wanted, minHeight), maxHeight);
  const height = innerHeight + kMargin.top + kMargin.bottom;
  const {context, width} = fitCanvas(place, height);
  const scale = Math.min(inner / (box.x1 - box.x0), innerHeight / (box.y1 - box.y0));
  const spareX = inner / scale - (box.x1 - box.x0);
  const spareY = innerHeight / scale - (box.y1 - box.y0);
  const view = {x0: box.x0 - spareX / 2, x1: box.x1 + spareX / 2, y0: box.y0 - spareY / 2, y1: box.y1 + spareY / 2};
  const map = {x: x => kMargin.left + (x - view.x0) * scale, y: y => height - kMargin.bottom - (y - view.y0) * scale};
  return {context, width, height, scale, view, map};
}
