// The path seen from above, with equal axes; it follows the charts' zoom and pointer.

function pathLines() {
  const lines = [];
  if (path.position_true_x_m) {
    lines.push({x: path.position_true_x_m, y: path.position_true_y_m, color: 'truth', width: 4});
  }
  lines.push({x: path.position_x_m, y: path.position_y_m, color: 'estimate', width: 1.6});
  return lines;
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
  const plane = fitPlane(place, box);
  const {context, map} = plane;
  drawGrid(plane, {x: `x, ${lengthUnit}`, y: `y, ${lengthUnit}`});
  for (const line of lines) drawLine(context, line, map, from, to);
  const estimate = lines[lines.length - 1];
  const mark = (i, fill, radius) => dot(context, map.x(estimate.x[i]), map.y(estimate.y[i]), fill, radius);
  mark(from, color('start'));
  mark(to - 1, color('end'));
  if (pointed !== null) mark(Math.round(pointed * (n - 1) / Math.max(time.length - 1, 1)), color('ink'), 6);
}

windowListeners.push(drawPath);
pointListeners.push(drawPath);
