// Fills the cards of the page.

const numberCell = value => element('td', {textContent: shown(value)});
const plainCell = value => element('td', {textContent: value});

function statusCell(status, job) {
  const text = job.messages ? link(job.messages, status) : status;
  return element('td', {className: status, title: job.failure || ''}, text);
}

function jobColumns() {
  const columns = [['job', job => job.id, (id, job) => element('td', {}, link(job.results, id))]];
  if (jobs.some(job => job.estimator)) columns.push(['estimator', job => job.estimator, plainCell]);
  columns.push(['status', job => job.status, statusCell]);
  for (const {figure} of metrics) {
    columns.push([element('span', {}, ...pathText(figure)), job => job.figures[figure], numberCell]);
  }
  columns.push(['time, s', job => job.wall_s, numberCell]);
  return columns;
}

function drawHeadline() {
  const ids = status => new Set(jobs.filter(job => job.status === status).map(job => job.id));
  const times = new Map(jobs.map(job => [job.id, job.wall_s || 0]));
  const failed = ids('failed');
  const total_s = [...times.values()].reduce((sum, time) => sum + time, 0);
  byId('headline').append(
    tile('finished', ids('finished').size, `of ${times.size} jobs`),
    tile('failed', failed.size, 'jobs', failed.size ? 'not in the statistics' : ''),
    tile('not run', ids('pending').size, 'jobs'),
    tile('time of all jobs', total_s >= 120 ? total_s / 60 : total_s, total_s >= 120 ? 'min' : 's', '', 3));
  byId('failures').hidden = !failed.size;
  for (const id of failed) {
    const job = jobs.find(one => one.id === id);
    byId('failures').lastElementChild.append(
      element('li', {}, link(job.messages, id), `: ${job.failure || ''}`));
  }
}

byId('subtitle').textContent = `stillkite ${summary.command || ''} · median with 95 % interval (order statistics, ` +
  'from 6 jobs) · 9 in 10: nine in ten jobs are not worse';
drawHeadline();
byId('metrics').append(...metrics.map(metricCard));
byId('jobs').append(sortableTable(jobColumns(), jobs));
document.documentElement.dataset.ready = String(metrics.length);
