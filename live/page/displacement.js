// Displacement from the pose to hold, from above: forward is up, left is left.

// Canvas in device pixels; its context uses CSS pixels.
function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const {clientWidth: width, clientHeight: height} = canvas;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return {context, width, height};
}

// Smallest 1, 2 or 5 times a power of ten that is at least `value`.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 5, 10].find(factor => factor * power >= value * (1 - 1e-9));
}

function drawDisplacement(displacement, unit) {
  const {context, width} = fitted(byId('displacement-view'));
  const centre = width / 2, radius = 0.42 * width;
  const hasLength = displacement && displacement.length !== undefined;
  const [major, minor, angle] = displacement?.ellipse || [0, 0, 0];
  const range = hasLength
    ? roundUp(Math.max(1.1 * Math.hypot(displacement.forward, displacement.left), 1.5 * major, 0.1)) : 1;
  const scale = radius / range;

  context.fillStyle = 'rgba(255, 255, 255, 0.85)';
  context.fillRect(0, 0, width, width);
  context.strokeStyle = '#555';
  context.lineWidth = 1.5;
  for (const part of [0.5, 1]) {
    context.beginPath();
    context.arc(centre, centre, part * radius, 0, 2 * Math.PI);
    context.stroke();
  }
  context.beginPath();
  context.moveTo(centre - 8, centre);
  context.lineTo(centre + 8, centre);
  context.moveTo(centre, centre - 8);
  context.lineTo(centre, centre + 8);
  context.lineWidth = 2.5;
  context.stroke();
  context.fillStyle = '#000';
  context.font = 'bold 13px system-ui, sans-serif';
  context.fillText(hasLength ? `${range} ${unit}` : displacement?.kind || '', 6, 16);
  if (!displacement || displacement.forward === undefined) return;

  context.save();
  context.translate(centre - scale * displacement.left, centre - scale * displacement.forward);
  if (displacement.ellipse) {
    context.beginPath();
    context.ellipse(0, 0, scale * major, scale * minor, -angle - Math.PI / 2, 0, 2 * Math.PI);
    context.fillStyle = 'rgba(0, 70, 184, 0.3)';
    context.fill();
    context.strokeStyle = '#0046b8';
    context.lineWidth = 2;
    context.stroke();
  }
  context.rotate(-displacement.yaw);
  context.beginPath();
  context.moveTo(0, -13);
  context.lineTo(8, 9);
  context.lineTo(0, 4);
  context.lineTo(-8, 9);
  context.closePath();
  context.fillStyle = '#b00020';
  context.fill();
  context.restore();
}

