// Top view of the path with equal axes; follows zoom and cursor of the charts. pathLines() of the page
// returns the lines: {x, y, color, width, end: color of the last point of an estimate}.

function drawPath() {
  const place = document.querySelector('.top-view');
  const lines = pathLines();
  if (!lines.length) return;
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
  const pointedAt = pointed === null ? null : Math.round(pointed * (n - 1) / Math.max(time.length - 1, 1));
  for (const {x, y, end} of lines.filter(line => line.end)) {
    const mark = (i, fill, radius) => dot(context, map.x(x[i]), map.y(y[i]), fill, radius);
    mark(from, color('start'));
    mark(to - 1, color(end));
    if (pointedAt !== null) mark(pointedAt, color('ink'), 6);
  }
}

windowListeners.push(drawPath);
pointListeners.push(drawPath);
