// A figure of the page: its plots below one another, each with its controls, in place of the still drawing.

/** What the page says in a `<script type="application/json">` of an element. */
function dataOf(root) {
  return JSON.parse(root.querySelector('script[type="application/json"]').textContent);
}

class LiveFigure {
  /** `live`: the element that the plots go into; `data`: as report/script_data.hpp says. */
  constructor(live, data, number, links) {
    this.said = element('p', {className: 'spoken', role: 'status', 'aria-live': 'polite'});
    this.plots = data.plots.map(plot => this.add(live, plot, data.columns, number, links));
    live.append(this.said);
  }

  add(live, data, columns, number, links) {
    const title = data.title || data.y.label;
    const canvas = element('div', {
      className: 'canvas',
      tabIndex: 0,
      role: 'application',
      'aria-roledescription': 'plot',
      'aria-label':
          `${title}: ${data.y.label} over ${data.x.label}. Left and right read values, up and down choose the ` +
          'trace, plus and minus zoom, 0 shows everything.',
    });
    const reading = element('span', {className: 'reading'}),
          controls = element('div', {className: 'controls', role: 'group'});
    controls.setAttribute('aria-label', `Controls of ${title}`);
    const box = element('div', {className: 'plot'}, element('h3', {textContent: data.title}), controls, canvas);
    live.append(box);
    let legend = null;
    const plot = new LivePlot(canvas, data, columns, links.follow.bind(links), () => {
      if (legend) reading.textContent = legend.read();
      if (plot && !plot.following) links.point(plot);
    });
    legend = new Legend(plot);
    plot.legend = legend;
    links.add(plot, number);
    new Keys(plot, text => this.say(text));
    box.append(legend.root, this.numbers(plot));
    controls.append(...this.controls(plot), reading);
    canvas.addEventListener('wheel', event => {
      // A pinch on a touch pad comes as a wheel with the control key.
      if (!event.ctrlKey) return;
      event.preventDefault();
      plot.zoom(event.deltaY < 0 ? 0.8 : 1.25);
    }, {passive: false});
    return plot;
  }

  /** Other data in the same plots. */
  setData(data) {
    this.plots.forEach((plot, i) => {
      plot.setData(data.plots[i], data.columns);
      plot.legend.fill();
      for (const axis of ['x', 'y']) plot.logSwitches[axis].disabled = !plot.canBeLog(axis);
    });
  }

  controls(plot) {
    const log = axis => {
      const out = toggle(`log ${axis}`, `Logarithmic ${axis} axis`, plot.log[axis], on => this.setLog(plot, axis, on));
      out.disabled = !plot.canBeLog(axis);
      return out;
    };
    plot.logSwitches = {x: log('x'), y: log('y')};
    return [
      button('+', 'Closer (drag over the plot: that part)', () => plot.zoom(0.5)),
      button('−', 'Farther', () => plot.zoom(2)),
      button('whole', 'Show everything (double click)', () => plot.showWhole()),
      plot.logSwitches.x,
      plot.logSwitches.y,
      button('copy CSV', 'Copy the shown traces in the shown range', () => this.copy(plot)),
    ];
  }

  /** Plots of one figure with the same x axis keep it the same. */
  setLog(plot, axis, log) {
    const same = other => other === plot || (axis === 'x' && other.data.x.label === plot.data.x.label);
    for (const other of this.plots.filter(same)) {
      if (!other.canBeLog(axis)) continue;
      other.setLog(axis, log);
      other.logSwitches[axis].setAttribute('aria-pressed', log);
    }
  }

  async copy(plot) {
    const table = tableOf(plot.data, plot.shown(), plot.view.x);
    const done = await copyText(csvText(table));
    this.say(done ? `${table.rows.length} rows are in the clipboard.` : 'The browser does not let this page copy.');
  }

  numbers(plot) {
    const out = element('details', {}, element('summary', {textContent: 'Data'}));
    out.addEventListener('toggle', () => {
      while (out.children.length > 1) out.lastChild.remove();
      if (out.open) out.append(dataTable(plot));
    });
    return out;
  }

  say(text) {
    this.said.textContent = text;
  }
}
