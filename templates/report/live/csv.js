// Traces as one table: a row for every x that any of them has.

/** {head, rows} of traces within [from, to] of x; null where a trace has no value. Loops keep their own order. */
function tableOf(plot, traces, [from, to]) {
  const inside = x => x !== null && x >= from && x <= to;
  if (traces.some(trace => !trace.sorted)) {
    const head = traces.flatMap(
        trace => [columnName(`${trace.name} ${plot.x.quantity}`, plot.x.unit), columnName(trace.name, plot.y.unit)]);
    const rows = [];
    for (let i = 0; i < Math.max(0, ...traces.map(trace => trace.x.length)); ++i) {
      const row = traces.flatMap(trace => i < trace.x.length ? [trace.x[i], trace.y[i]] : [null, null]);
      if (traces.some((_, k) => inside(row[2 * k]))) rows.push(row);
    }
    return {head, rows};
  }
  const rows = new Map();
  traces.forEach((trace, k) => trace.x.forEach((value, i) => {
    if (!inside(value)) return;
    if (!rows.has(value)) rows.set(value, [value, ...traces.map(() => null)]);
    rows.get(value)[k + 1] = trace.y[i];
  }));
  const head = [columnName(plot.x.quantity, plot.x.unit), ...traces.map(trace => columnName(trace.name, plot.y.unit))];
  return {head, rows: [...rows.values()].sort((a, b) => a[0] - b[0])};
}

function csvText({head, rows}) {
  return [head.join(','), ...rows.map(row => row.map(value => value === null ? '' : value).join(','))].join('\n') +
      '\n';
}

/** Into the clipboard, also from a file that a browser grants no clipboard; whether that worked. */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const field = element('textarea', {readOnly: true, value: text});
    document.body.append(field);
    field.select();
    const done = document.execCommand('copy');
    field.remove();
    return done;
  }
}
