// Key figures of summary.json.

function drawHeadline() {
  const frames = summary.frames || {};
  const timing = summary.timing || {};
  const frameTime = timing.frame_ms || {};
  const scale = summary.scale || {};
  const memory = summary.memory || {};
  const evaluation = summary.evaluation;
  const tiles = [];
  if (evaluation) {
    tiles.push(
      tile('Drift', evaluation.drift_percent, '%', `of a path of ${shown(evaluation.path_length_m)} m`),
      tile('Position RMSE', evaluation.position_rmse_m, 'm', `${evaluation.matched} frames with truth`),
      tile('End error', evaluation.end_error_horizontal_m, 'm',
           `vertical ${shown(evaluation.end_error_vertical_m)} m`),
      tile('Tilt RMSE', degrees(evaluation.tilt_rmse_rad), '°', `yaw ${shown(degrees(evaluation.yaw_rmse_rad))}°`));
  }
  tiles.push(
    tile('Frames used', frames.used, `of ${frames.read ?? '–'}`, `${frames.rejected ?? '–'} rejected`),
    tile('Time per frame', frameTime.median, 'ms', `99th percentile ${shown(frameTime.p99)} ms`),
    tile('Throughput', timing.frames_per_s, 'frames/s', 'decoding included'),
    tile('Peak memory', memory.peak_rss_mib, 'MiB'));
  byId('headline').append(...tiles);

  const source = {none: 'no scale: lengths are in initial heights'}[scale.source] ||
    (scale.source ? `scale from ${scale.source.replaceAll('_', ' ')}` : '');
  byId('subtitle').textContent = [`${shown(duration)} s`, source,
    data.decimated ? 'charts show minimum and maximum per interval' : '']
    .filter(Boolean).join(' · ');
  byId('summary').textContent = JSON.stringify(summary, null, 2);
}

function drawErrorTable() {
  const evaluation = summary.evaluation;
  if (!evaluation) {
    byId('error_table').remove();
    return;
  }
  const rows = [];
  for (const [name, key, unit] of [['Velocity', 'velocity', 'm_s'], ['Angular rate', 'angular_rate', 'rad_s']]) {
    const of = (figure, axis) => (evaluation[figure] || [])[axis];
    for (const axis of [0, 1, 2]) {
      rows.push([`${name} ${'xyz'[axis]}, ${unit.replace('_', '/')}`, of(`${key}_rmse_${unit}`, axis),
                 of(`${key}_median_abs_error_${unit}`, axis), of(`${key}_correlation`, axis)]);
    }
  }
  byId('error_table').append(element('h3', {textContent: 'In the camera frame'}),
    table(['', 'RMSE', 'median |error|', 'correlation'], rows));
  const nees = Object.entries(evaluation.nees || {}).filter(([, value]) => value);
  if (nees.length) {
    byId('error_table').append(
      element('h3', {textContent: 'Covariance consistency (NEES)'}),
      table(['', 'mean', 'expected', 'within 95 % interval', 'beyond 3σ', 'beyond 5σ', 'σ / RMS error'],
            nees.map(([name, value]) => {
              const {share_beyond_3_sigma, share_beyond_5_sigma, sigma_over_rms} = (evaluation.consistency || {})[name] || {};
              return [name.replaceAll('_', ' '), value.mean, value.degrees_of_freedom,
                      ...[value.share_inside, share_beyond_3_sigma, share_beyond_5_sigma].map(
                        share => share === undefined ? '–' : `${shown(100 * share, 3)} %`), sigma_over_rms];
            })));
  }
}
