// Common frame, style and interaction of the dygraphs charts.

const kAxisWidth = 46;

const finite = value => Number.isNaN(value) ? null : value;

// One finger scrolls the page, two fingers zoom the chart.
const kTwoFingers = Object.fromEntries(['touchstart', 'touchmove', 'touchend'].map(kind => [kind,
  (event, graph, context) => {
    if (kind === 'touchend' || event.touches.length > 1) {
      Dygraph.defaultInteractionModel[kind](event, graph, context);
    }
  }]));

// Frame of a chart: header with title and readout, and the plot element.
function addPlot(card, title, unit, height) {
  const readout = element('span', {className: 'readout'});
  const plot = element('div', {className: 'plot'});
  plot.style.height = `${height}px`;
  card.append(element('div', {className: 'chart'}, element('div', {className: 'chart-head'},
    element('span', {textContent: unit ? `${title}, ${unit}` : title}), readout), plot));
  return {plot, readout};
}

const plotColors = () => ({gridLineColor: color('grid'), axisLineColor: color('line')});

const plotOptions = ({timeAxis, pixelsPerLabel}) => ({
  legend: 'never',
  ...plotColors(),
  axisLabelFontSize: 11,
  highlightCircleSize: 3,
  axes: {
    x: {axisLabelFormatter: t => `${shown(t)} s`, pixelsPerLabel: 70, drawAxis: timeAxis},
    y: {axisLabelWidth: kAxisWidth, pixelsPerLabel, axisLabelFormatter: value => shown(value)}
  },
  interactionModel: {...Dygraph.defaultInteractionModel, ...kTwoFingers}
});

function addKeys(card, keys) {
  card.append(element('div', {className: 'keys'}, ...keys.map(([label, name, kind]) => {
    const mark = element('i', {className: kind || ''});
    mark.style[kind === 'band' || kind === 'point' ? 'background' : 'borderColor'] = `var(--${name})`;
    return element('span', {className: 'key'}, mark, label);
  })));
}
