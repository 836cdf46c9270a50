// Verdicts over time.

function drawStrip(place, stretches) {
  const {context, width, height} = fitCanvas(place, place.clientHeight);
  const [start, end] = timeWindow || [0, duration];
  const left = kAxisWidth;
  const scale = (width - left) / Math.max(end - start, 1e-9);
  const edge = t => left + Math.min(Math.max((t - start) * scale, 0), width - left);
  // `ok` first, so that a single other frame stays visible in a long flight
  const ordered = [...stretches].sort((a, b) => (a[0] !== 'ok') - (b[0] !== 'ok'));
  for (const [verdict, from, to] of ordered) {
    if (to < start || from > end) continue;
    context.fillStyle = color(verdict) || color('time_gap');
    context.fillRect(edge(from), 0, Math.max(edge(to) - edge(from), 1.5), height);
  }
}

function addVerdictLegend(counts) {
  const total = Object.values(counts).reduce((sum, count) => sum + count, 0);
  const items = Object.entries(counts).filter(([, count]) => count > 0).sort((a, b) => b[1] - a[1]);
  document.querySelector('#verdicts .legend').append(...items.map(([verdict, count]) => {
    const swatch = element('span', {className: 'swatch'});
    swatch.style.background = `var(--${verdict}, var(--time_gap))`;
    return element('li', {}, swatch, `${verdict.replaceAll('_', ' ')} `, element('b', {textContent: String(count)}),
                   ` (${shown(100 * count / total, 2)} %)`);
  }));
}

windowListeners.push(drawVerdicts);
