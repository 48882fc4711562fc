// The list of a plot's traces: each a switch, with its value under the cursor next to it.

const MANY_TRACES = 4;

/** The piece of line that stands for a trace. */
function swatch(trace) {
  const svg = (name, attributes) => {
    const out = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) out.setAttribute(key, value);
    return out;
  };
  const out =
      svg('svg', {'width': 26, 'height': 12, 'aria-hidden': 'true', 'class': `trace-${trace.colour % TRACE_COLOURS}`});
  out.append(
      trace.style === 'marks' ?
          svg('circle', {cx: 13, cy: 6, r: 3.6, fill: 'none'}) :
          svg('path', {'d': 'M1 6h24', 'stroke-dasharray': traceDash(trace).join(' ') || 'none'}));
  return out;
}

class Legend {
  constructor(plot) {
    this.plot = plot;
    this.root = element('ul', {className: 'traces', 'aria-label': `Traces of ${plot.data.title || plot.data.y.label}`});
    this.fill();
  }

  fill() {
    const {plot, root} = this;
    root.replaceChildren();
    this.values = [];
    this.switches = plot.traces.map((trace, k) => {
      const one =
          toggle('', 'Show or hide this trace; double click: this one alone', trace.shown, on => plot.show(k, on));
      one.append(swatch(trace), element('span', {textContent: trace.name}));
      one.addEventListener('dblclick', () => this.showAll(other => other === k));
      this.values.push(element('span', {className: 'value'}));
      root.append(element('li', {}, one, this.values[k]));
      return one;
    });
    if (plot.traces.length <= MANY_TRACES) return;
    root.append(element(
        'li', {}, button('all', 'Show every trace', () => this.showAll(() => true)),
        button('none', 'Hide every trace', () => this.showAll(() => false))));
  }

  showAll(wanted) {
    this.plot.u.batch(() => this.switches.forEach((one, k) => {
      one.setAttribute('aria-pressed', wanted(k));
      this.plot.show(k, wanted(k));
    }));
  }

  /** Values under the cursor. A trace with no sample at the cursor's own place says where its sample is. */
  read() {
    const {plot} = this, {x, y} = plot.data;
    const places = plot.at.map((i, k) => i === null ? null : plot.traces[k].x[i]);
    const place = places.find(value => value !== null && value !== undefined);
    this.values.forEach((field, k) => {
      const i = plot.at[k];
      if (i === null || i === undefined) {
        field.textContent = '';
        return;
      }
      const elsewhere = places[k] === place ? '' : ` at ${valueText(places[k], x.unit)}`;
      field.textContent = valueText(plot.traces[k].y[i], y.unit) + elsewhere;
    });
    return place === undefined ? '' : `${x.quantity}: ${valueText(place, x.unit)}`;
  }
}
