// Data of the page, and helpers.

const data = JSON.parse(document.getElementById('data').textContent);
const summary = data.summary || {};

const decode = text => new Float32Array(
  Uint8Array.from(atob(text), character => character.charCodeAt(0)).buffer);
const decodeAll = texts => Object.fromEntries(
  Object.entries(texts).map(([name, text]) => [name, decode(text)]));

const byId = id => document.getElementById(id);
const color = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function element(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

// Number with `digits` significant digits; a dash without a number.
function shown(value, digits = 4) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-5) return value.toExponential(2);
  return size >= 10 ** (digits - 1) ? value.toFixed(0) : String(Number(value.toPrecision(digits)));
}

// Canvas of the width of `place`, in device pixels; its 2-D context uses CSS pixels.
function fitCanvas(place, height) {
  const canvas = place.querySelector('canvas') || place.appendChild(element('canvas'));
  const width = place.clientWidth;
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return {canvas, context, width, height};
}
