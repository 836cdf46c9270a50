// The page: values, alarms, buttons, and the loops that request state and image.

let control = 'nobody';   // who commands
let flightId = null;      // differs between two starts of the program
let sentAt = null;        // time of the last command
let lastContact = performance.now();

const isNumber = value => typeof value === 'number' && Number.isFinite(value);

function setValue(id, value, digits, unit) {
  const place = byId(id);
  place.classList.remove('word');
  place.textContent = isNumber(value) ? value.toFixed(digits) : '–';
  if (!isNumber(value)) return;
  const small = document.createElement('i');
  small.textContent = unit;
  place.append(small);
}
function setWord(id, text) {
  byId(id).classList.add('word');
  byId(id).textContent = text;
}
function signed(value, digits = 2) {
  const size = Math.abs(value).toFixed(digits);
  return Number(size) === 0 ? size : `${value < 0 ? '−' : '+'}${size}`;
}
// Semi-axes, in centimetres or millimetres where metres are too coarse.
function axesText(major, minor, angle, unit) {
  const [factor, digits, name] = unit !== 'm' || major >= 0.1 ? [1, 2, unit] : major >= 0.01 ? [100, 1, 'cm'] : [1000, 1, 'mm'];
  return `${(factor * major).toFixed(digits)} × ${(factor * minor).toFixed(digits)} ${name}`;
}
const words = token => token.replaceAll('_', ' ');

function duration(time_s) {
  if (time_s < 60) return `${time_s.toFixed(time_s < 10 ? 1 : 0)} s`;
  return `${Math.floor(time_s / 60)} min ${Math.floor(time_s % 60)} s`;
}

function showDisplacement(displacement, unit) {
  drawDisplacement(displacement, unit);
  const note = byId('displacement-note');
  note.textContent = '';
  if (displacement.length !== undefined) {
    setValue('displacement', displacement.length, 2, unit);
    const ellipse = displacement.ellipse ? `95 %: ${axesText(...displacement.ellipse, unit)}` : 'not significant';
    note.textContent = `${ellipse}\nup ${signed(displacement.up)} ${unit}`;
  } else {
    setWord('displacement', displacement.kind === 'direction' ? 'direction only' : 'unknown');
  }
}

function showEstimate(estimate) {
  byId('verdict').textContent = estimate ? estimate.verdict_words : 'no image';
  byId('verdict').className = `pill ${estimate?.is_measured ? 'good' : 'bad'}`;
  if (!estimate) return;
  lengthUnit = estimate.unit;
  const unit = estimate.unit === 'm' ? 'm' : 'h';
  setValue('speed', estimate.speed, 2, `${unit}/s`);
  byId('vertical-speed').textContent = isNumber(estimate.vertical_speed) ? `up ${signed(estimate.vertical_speed)}` : '';
  setValue('height', estimate.height, 2, unit);
  byId('height-note').textContent = !isNumber(estimate.height) ? '' : unit === 'h' ? 'h: initial heights' : 'above ground';
  showDisplacement(estimate.displacement, unit);
  setWord('scale', words(estimate.scale.source));
  byId('scale-note').textContent = estimate.scale.source === 'none' ? '' : `${duration(estimate.scale.age_s)} old`;
  setValue('latency', estimate.latency_ms, 0, 'ms');
  byId('source').textContent = `estimator: ${estimate.source}`;
}

function showAlarms(alarms) {
  const shown = [...byId('alarms').children].map(item => item.textContent);
  if (shown.join('\n') === alarms.join('\n')) return;
  byId('alarms').replaceChildren(...alarms.map(text => {
    const item = document.createElement('li');
    item.textContent = text;
    return item;
  }));
}

// Result of the last command, as the program reports it.
function showAnswer(messages) {
  const isAnswer = ([age, text]) => text.startsWith('operator: ') && performance.now() - sentAt > 1000 * age;
  const answer = sentAt === null ? undefined : messages.findLast(isAnswer);
  if (!answer) return;
  const text = answer[1].replace('operator: ', '');
  const isRefused = text.includes(' refused: ');
  // a mark is reported as JSON
  const accepted = answer[0] > 6 ? '' : `${text.startsWith('{') ? 'mark' : words(text)}: accepted`;
  byId('answer').textContent = isRefused ? words(text) : accepted;
  byId('answer').classList.toggle('refused', isRefused);
}

function showMessages(messages) {
  showAnswer(messages);
  byId('messages').replaceChildren(...messages.slice(-8).reverse().map(([age, text]) => {
    const item = document.createElement('li');
    const time = document.createElement('time');
    time.textContent = `−${duration(Math.max(age, 0))}`;
    item.append(time, text);
    return item;
  }));
}

function showReplay(replay) {
  byId('replay').hidden = !replay;
  if (replay) byId('replay').textContent = `replay ${duration(replay.time_s)}${replay.speed === 1 ? '' : ` × ${replay.speed}`}`;
}

function showControl(state, isReplay) {
  byId('control').hidden = !state || isReplay;
  byId('control-state').hidden = !state;
  if (!state) return;
  const pill = byId('control-state');
  pill.textContent = state.stopped ? 'stopped' : state.engaged ? 'engaged' : 'not engaged';
  pill.className = `pill ${state.stopped ? 'bad' : state.engaged ? 'active' : ''}`;
  const isOwn = control === 'this_operator';
  byId('take').hidden = isOwn;
  byId('take').disabled = control === 'other_operator';
  byId('control-note').textContent = control === 'other_operator' ? 'Another operator has control; this page only watches.'
    : isOwn ? `You have control: ${state.reason || 'no image'}.` : 'Nobody has control.';
  for (const button of document.querySelectorAll('[data-command]')) {
    button.hidden = !isOwn;
    button.disabled = state.stopped && button.id !== 'mark';
  }
  byId('note').hidden = !isOwn;
  byId('return').hidden = !isOwn;
}

function showState({control: holder, flight}) {
  if (flight.flight !== flightId) {
    flightId = flight.flight;
    samples = [];
    lastImage = -1;
  }
  control = holder;
  addSamples(flight.samples);
  showEstimate(flight.estimate);
  showAlarms(flight.alarms);
  showMessages(flight.messages);
  showControl(flight.control, flight.replay !== null);
  showReplay(flight.replay);
  setValue('rate', flight.images.used_per_s, 0, '/s');
  const ratio = flight.images.dropped_ratio;
  byId('dropped').textContent = isNumber(ratio) ? `${(100 * ratio).toFixed(0)} % dropped` : '';
  drawHistory();
}

async function pollState() {
  for (;;) {
    let isConnected = false;
    try {
      const after = samples.length ? samples[samples.length - 1].number : -1;
      const response = await request(`/state?after=${after}`);
      if (response.ok) {
        showState(await response.json());
        lastContact = performance.now();
        isConnected = true;
      } else if (response.status !== 401) {
        showAlarms([`Refused: ${await response.text()}`]);
      }
    } catch (error) {
      showAlarms([`No connection to the program for ${((performance.now() - lastContact) / 1000).toFixed(0)} s`]);
    }
    byId('main').classList.toggle('stale', !isConnected);
    await pause(isConnected ? 200 : 1000);
  }
}

let lastImage = -1, lastUrl = null;
async function pollImage() {
  for (;;) {
    const start = performance.now();
    let isConnected = !document.hidden;
    try {
      const response = document.hidden ? null : await request(`/image?after=${lastImage}`);
      if (response && response.status === 200) {
        lastImage = Number(response.headers.get('X-Image'));
        const url = URL.createObjectURL(await response.blob());
        byId('image').src = url;
        await byId('image').decode();
        if (lastUrl) URL.revokeObjectURL(lastUrl);
        lastUrl = url;
      }
    } catch (error) {
      isConnected = false;
    }
    await pause(isConnected ? Math.max(10, 100 - (performance.now() - start)) : 500);
  }
}

async function act(path, body, text) {
  const answer = byId('answer');
  answer.classList.remove('refused');
  answer.textContent = text;
  try {
    await post(path, body);
  } catch (error) {
    answer.classList.add('refused');
    answer.textContent = `Not sent: ${error.message}`;
  }
}

for (const button of document.querySelectorAll('[data-command]')) {
  button.addEventListener('click', () => {
    const command = {command: button.dataset.command};
    if (button.id === 'mark' && byId('note').value) command.note = byId('note').value;
    sentAt = performance.now();
    act('/command', JSON.stringify(command), `${button.textContent} …`);
    if (button.id === 'mark') byId('note').value = '';
  });
}
byId('take').addEventListener('click', () => act('/take_control', '', ''));
byId('return').addEventListener('click', () => act('/return_control', '', ''));

pollState();
pollImage();
