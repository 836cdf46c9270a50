// Time series of the flight.

const lengthUnit = data.length_unit;
const speedUnit = `${lengthUnit}/s`;
const columns = decodeAll(data.columns);
const path = decodeAll(data.path);
const time = columns.time_s || new Float32Array();
const duration = time.length ? time[time.length - 1] : 0;

const degrees = value => typeof value === 'number' ? value * 180 / Math.PI : undefined;
