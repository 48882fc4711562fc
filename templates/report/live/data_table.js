// A plot's numbers as a table, made when it is asked for: what is shown, as far as a page can bear.

const MOST_ROWS = 500;

function dataTable(plot) {
  const {head, rows} = tableOf(plot.data, plot.shown(), plot.view.x);
  const step = Math.max(1, Math.ceil(rows.length / MOST_ROWS));
  const shown = rows.filter((_, i) => i % step === 0);
  const which = step === 1 ? `${rows.length} rows` : `every ${step}th of ${rows.length} rows; a copy as CSV has all`;
  const cell = value => element('td', {textContent: value === null ? '' : String(value)});
  return element(
      'div', {
        className: 'wide rows',
        tabIndex: 0,
        role: 'region',
        'aria-label': `Data of ${plot.data.title || plot.data.y.label}`
      },
      element(
          'table', {}, element('caption', {textContent: `Shown traces in the shown range, ${which}.`}),
          element(
              'thead', {}, element('tr', {}, ...head.map(text => element('th', {scope: 'col', textContent: text})))),
          element('tbody', {}, ...shown.map(row => element('tr', {}, ...row.map(cell))))));
}
