// Histograms of the displacement along the moved axis, with and without stabilization.

const kBarHeight = 190;

// [[bin, count]] to [[bin, percent]].
function sharesOf(counts) {
  const total = counts.reduce((sum, [, count]) => sum + count, 0);
  return counts.map(([bin, count]) => [bin, 100 * count / total]);
}

function drawHistogram(place) {
  const {size_m: size, on, off} = sets[place.dataset.axis].histogram;
  const shares = {off: sharesOf(off), on: sharesOf(on)};
  const all = [...shares.on, ...shares.off];
  const maxDisplacement = size * (Math.max(...all.map(([bin]) => Math.abs(bin)), 1) + 1);
  const maxShare = Math.max(...all.map(([, share]) => share));
  const {context, width, height} = fitCanvas(place, kBarHeight + kMargin.top + kMargin.bottom);
  const scale = (width - kMargin.left - kMargin.right) / (2 * maxDisplacement);
  const map = {x: d => kMargin.left + (d + maxDisplacement) * scale,
               y: share => height - kMargin.bottom - share / (1.05 * maxShare) * kBarHeight};
  drawBarGrid(context, map, width, height, maxDisplacement, maxShare);
  for (const state of ['off', 'on']) {
    context.fillStyle = color(`${state}_bar`);
    for (const [bin, share] of shares[state]) {
      const left = map.x((bin - 0.5) * size);
      context.fillRect(left, map.y(share), Math.max(size * scale - 0.6, 1), map.y(0) - map.y(share));
    }
  }
}

function drawBarGrid(context, map, width, height, maxDisplacement, maxShare) {
  const label = (text, x, y, align, baseline) => {
    context.textAlign = align;
    context.textBaseline = baseline;
    context.fillText(text, x, y);
  };
  context.font = '11px system-ui, sans-serif';
  context.fillStyle = color('soft');
  context.strokeStyle = color('grid');
  const line = (x0, y0, x1, y1) => { context.beginPath(); context.moveTo(x0, y0); context.lineTo(x1, y1); context.stroke(); };
  const across = niceStep(2 * maxDisplacement, width / 60);
  for (let k = -Math.floor(maxDisplacement / across); k * across <= maxDisplacement; ++k) {
    line(map.x(k * across), kMargin.top, map.x(k * across), map.y(0));
    label(shown(k * across), map.x(k * across), map.y(0) + 6, 'center', 'top');
  }
  const up = niceStep(maxShare, 4);
  for (let k = 0; k * up <= 1.05 * maxShare; ++k) {
    line(kMargin.left, map.y(k * up), width - kMargin.right, map.y(k * up));
    label(`${shown(k * up)} %`, kMargin.left - 6, map.y(k * up), 'right', 'middle');
  }
}

function addHistograms() {
  for (const axis of flownAxes) {
    const {size_m: size, on, off} = sets[axis].histogram;
    if (!on.length && !off.length) continue;
    const place = element('div', {className: 'bars'});
    place.dataset.axis = axis;
    const card = element('section', {className: 'card'},
      element('h3', {textContent: `Station moved along ${axis}`}));
    addKeys(card, stateKeys.map(([label, name]) => [label, `${name}_bar`, 'band']));
    card.append(place, element('figcaption', {textContent:
      `displacement d along ${axis}, m; share of the frames in bins of ${shown(100 * size)} cm`}));
    byId('histograms').append(card);
  }
}

const drawHistograms = () => document.querySelectorAll('.bars').forEach(drawHistogram);
