// Replay of a trial.

const player = {trial: null, t_s: 0, speed: 4, playing: false, last_ms: null};

// Last sample at or before time t.
function indexAt(trial, t) {
  const times = trial.replay.time_s;
  let low = 0;
  for (let high = times.length; high - low > 1;) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return low;
}

function drawImage() {
  const {trial, t_s: t} = player;
  const shownImage = trial.images.filter(([at]) => at <= t).pop() || trial.images[0];
  if (shownImage && byId('image').at !== shownImage) {
    byId('image').at = shownImage;
    byId('image').src = `data:image/jpeg;base64,${shownImage[1]}`;
  }
}

function drawReadings(index) {
  const {replay, axis} = player.trial;
  const item = (name, value, unit) => element('span', {}, `${name} `, element('b', {textContent: value}), unit);
  byId('readings').replaceChildren(
    item('time', tenths(player.t_s), ' s'),
    ...kAxes.map(name => item(name === axis ? `d = d${name}` : `d${name}`, tenths(100 * replay[`displacement_${name}`][index]), ' cm')),
    item('yaw', tenths(replay.yaw_deg[index]), '°'));
  const decision = replay.decision[index];
  const swatch = element('span', {className: 'swatch'});
  if (decision >= 0) swatch.style.background = decisionColor(decision);
  byId('decision').replaceChildren(...(decision >= 0 ? [swatch, decisionWords(decision)]
    : ['no stabilization: the drone follows its station']));
}

// Controller decisions along the time slider.
function drawReplayStrip() {
  const {replay} = player.trial;
  const {context, width, height} = fitCanvas(byId('replay_strip'), 12);
  const scale = width / Math.max(durationOf(player.trial), 1e-9);
  replay.decision.forEach((decision, i) => {
    if (!(decision >= 0)) return;
    const end = i + 1 < replay.time_s.length ? replay.time_s[i + 1] : replay.time_s[i];
    context.fillStyle = decisionColor(decision);
    context.fillRect(replay.time_s[i] * scale, 0, (end - replay.time_s[i]) * scale + 0.5, height);
  });
}

function drawReplay() {
  const {trial} = player;
  if (!trial) return;
  const index = indexAt(trial, player.t_s);
  drawReplayView(byId('top_view'), trial, kTopView, index);
  drawReplayView(byId('side_view'), trial, sideView(trial), index);
  drawImage();
  drawReadings(index);
  byId('scrub').value = player.t_s;
}

function choose(trial) {
  Object.assign(player, {trial, t_s: 0});
  byId('scrub').max = durationOf(trial);
  byId('side_name').textContent = `Side view, ${sets[trial.axis].across} to the right`;
  byId('camera').hidden = !trial.images.length;
  document.querySelector('.views').classList.toggle('with-camera', trial.images.length > 0);
  drawReplayKeys(trial);
  drawReplayStrip();
  drawReplay();
}

function setPlaying(playing) {
  Object.assign(player, {playing, last_ms: null});
  byId('play').textContent = playing ? '❚❚' : '▶';
  byId('play').ariaLabel = playing ? 'Pause' : 'Play';
  if (playing) requestAnimationFrame(advance);
}

function advance(now_ms) {
  if (!player.playing) return;
  const end = durationOf(player.trial);
  if (player.last_ms !== null) player.t_s = Math.min(end, player.t_s + player.speed * (now_ms - player.last_ms) / 1000);
  player.last_ms = now_ms;
  drawReplay();
  if (player.t_s >= end) setPlaying(false); else requestAnimationFrame(advance);
}

function trialName(trial, i) {
  const mean = centimetres(rowOf(trial).mean_m);
  return [`${i + 1}: along ${trial.axis}`, trial.state, mean === undefined ? '' : `mean ${tenths(mean)} cm`,
          trial.images.length ? 'camera' : '']
    .filter(Boolean).join(', ');
}

function addReplay() {
  const watched = trials.map((trial, i) => [trial, i]).filter(([trial]) => trial.replay.time_s.length);
  byId('replay').hidden = !watched.length;
  if (!watched.length) return;
  byId('replay_trial').append(...watched.map(([trial, i]) => element('option', {value: String(i), textContent: trialName(trial, i)})));
  byId('replay_speed').append(...[0.5, 1, 2, 4, 8].map(speed => element('option',
    {value: String(speed), textContent: `${speed} ×`, selected: speed === player.speed})));
  const [first, place] = watched.find(([trial]) => trial.images.length) || watched[0];
  byId('replay_trial').value = String(place);
  choose(first);
  byId('replay_trial').addEventListener('change', event => choose(trials[Number(event.target.value)]));
  byId('replay_speed').addEventListener('change', event => { player.speed = Number(event.target.value); });
  byId('scrub').addEventListener('input', event => {
    player.t_s = Number(event.target.value);
    drawReplay();
  });
  byId('play').addEventListener('click', () => {
    if (!player.playing && player.t_s >= durationOf(player.trial)) player.t_s = 0;
    setPlaying(!player.playing);
  });
}
