'use strict';
// Requests to the program.

// Script errors as data-errors of the root element.
window.onerror = (message, source, line) => {
  const root = document.documentElement;
  root.dataset.errors = `${root.dataset.errors || ''}${message} (line ${line}); `;
};

const byId = id => document.getElementById(id);
const pause = time_ms => new Promise(resolve => setTimeout(resolve, time_ms));

// Of this tab; a page that is loaded again keeps its control.
const operatorId = (() => {
  let id = sessionStorage.getItem('operator');
  if (!id) {
    id = [...crypto.getRandomValues(new Uint8Array(16))].map(byte => byte.toString(16).padStart(2, '0')).join('');
    sessionStorage.setItem('operator', id);
  }
  return id;
})();

// Answer of the program; throws without one in 3 s. A missing token is asked for.
async function request(path, options = {}) {
  const headers = {'X-Operator': operatorId, ...options.headers};
  const token = sessionStorage.getItem('token');
  if (token) headers.Authorization = `Bearer ${token}`;
  const response = await fetch(path, {...options, headers, cache: 'no-store', signal: AbortSignal.timeout(3000)});
  byId('token-form').hidden = response.status !== 401;
  return response;
}

// Text of the answer; a refusal is an error with its reason.
async function post(path, body = '') {
  const response = await request(path, {method: 'POST', body, headers: {'Content-Type': 'application/json'}});
  const text = await response.text();
  if (!response.ok) throw new Error(text);
  return text;
}

byId('token-form').addEventListener('submit', event => {
  event.preventDefault();
  sessionStorage.setItem('token', byId('token').value);
});

