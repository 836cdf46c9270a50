// Fills the cards of the page.

function drawCanvases() {
  drawHistograms();
  drawHeatMaps();
  if (player.trial) drawReplayStrip();
  drawReplay();
}

drawHeadline();
drawTableOne();
drawDisplacements();
addHistograms();
addHeatMaps();
addReplay();
drawDecisions();
addTrialTable();
for (const id of ['displacement', 'heat_maps']) byId(id).hidden = !flownAxes.length;
document.querySelector('.above').hidden = !flownAxes.length;
drawCanvases();

window.addEventListener('resize', drawCanvases);
window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  for (const {graph, set} of displacementCharts) graph.updateOptions({colors: colorsOfSet(set), ...plotColors()});
  drawCanvases();
});
document.documentElement.dataset.ready = String(document.querySelectorAll('canvas').length);
