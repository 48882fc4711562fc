// One plot on a canvas, by uPlot: its view (what part of its axes is shown), its cursor and its traces.

const CURSOR_REACH = 40;  // pixels within which a mark, or a sample of a loop, is meant
const NARROW = 600;       // pixels: what is narrower is a phone

class LivePlot {
  /** `viewed(plot)` and `pointed(plot)` are called when the reader has changed the view, or moved the cursor. */
  constructor(host, data, columns, viewed, pointed) {
    Object.assign(this, {host, data, viewed, pointed});
    this.traces = makeTraces(data, columns);
    this.log = {x: data.x.log, y: data.y.log};
    this.view = this.whole();
    this.at = this.traces.map(() => null);  // the sample of each trace that the cursor means
    this.build();
    new ResizeObserver(() => this.u.setSize(this.size())).observe(host);
  }

  // --- view

  whole() {
    const range = axis => wholeRange(this.data[axis], this.traces.flatMap(trace => trace[axis]), this.log[axis]);
    return {x: range('x'), y: range('y')};
  }

  canBeLog(axis) {
    return this.traces.every(trace => trace[axis].every(value => value === null || value > 0));
  }

  /** {x: [from, to]}, {y: …} or both; `tell`: it was the reader who asked. */
  setView(view, tell = true) {
    Object.assign(this.view, view);
    this.u.batch(() => {
      for (const axis of ['x', 'y']) this.u.setScale(axis, {min: this.view[axis][0], max: this.view[axis][1]});
    });
    if (tell) this.viewed(this);
  }

  showWhole() {
    this.setView(this.whole());
  }

  /** Both axes about the cursor or the middle; `factor` below 1 goes closer. */
  zoom(factor, axes = ['x', 'y']) {
    const whole = this.whole(), {left, top} = this.u.cursor;
    const pointed = {
      x: left >= 0 ? left : this.u.over.clientWidth / 2,
      y: top >= 0 ? top : this.u.over.clientHeight / 2
    };
    const view = {};
    for (const axis of axes) {
      const centre = this.u.posToVal(pointed[axis], axis);
      view[axis] = zoomed(this.view[axis], centre, factor, whole[axis], this.log[axis]);
    }
    this.setView(view);
  }

  setLog(axis, log) {
    this.log[axis] = log;
    this.view[axis] = this.whole()[axis];
    this.build();
    this.viewed(this);
  }

  // --- traces

  show(k, shown) {
    this.traces[k].shown = shown;
    this.u.setSeries(k + 1, {show: shown}, false);
  }

  shown() {
    return this.traces.filter(trace => trace.shown);
  }

  /** Other data in place of those that are there: what the reader has zoomed to, or hidden, stays so. */
  setData(data, columns) {
    const before = this.whole(), hidden = new Set(this.traces.filter(trace => !trace.shown).map(trace => trace.name));
    this.data = data;
    this.traces = makeTraces(data, columns);
    for (const trace of this.traces) trace.shown = trace.shown && !hidden.has(trace.name);
    this.at = this.traces.map(() => null);
    for (const axis of ['x', 'y']) {
      this.log[axis] = this.log[axis] && this.canBeLog(axis);
      const zoomed = this.view[axis].some((value, i) => value !== before[axis][i]);
      if (!zoomed) this.view[axis] = this.whole()[axis];
    }
    this.build();
  }

  // --- cursor

  /** Puts the cursor on sample i of trace k. */
  pointAt(k, i) {
    const trace = this.traces[k];
    this.u.setCursor({left: this.u.valToPos(trace.x[i], 'x'), top: this.u.valToPos(trace.y[i], 'y')}, false);
    this.at = this.traces.map((_, other) => other === k ? i : this.nearest(other));
    this.pointed(this);
  }

  /** Follows the cursor of a plot with the same x axis. */
  followX(x) {
    const left = x === null ? -10 : this.u.valToPos(x, 'x');
    const inside = left >= 0 && left <= this.u.over.clientWidth;
    this.following = true;
    this.u.setCursor({left: inside ? left : -10, top: inside ? 0 : -10}, false);
    this.cursorMoved();
    this.following = false;
  }

  /** Where the cursor is; null: nowhere. */
  cursorX() {
    const left = this.u.cursor.left;
    return left === undefined || left < 0 ? null : this.u.posToVal(left, 'x');
  }

  nearest(k) {
    const trace = this.traces[k], {left, top} = this.u.cursor;
    if (!trace || !trace.shown || left < 0) return null;
    const toX = value => this.u.valToPos(value, 'x'), toY = value => this.u.valToPos(value, 'y');
    if (!trace.sorted)
      return this.following ? null : nearestInPlane(trace, left, top, toX, toY, this.log, CURSOR_REACH);
    const i = nearestInX(trace, this.u.posToVal(left, 'x'), toX, this.log);
    if (i === null || (trace.style === 'marks' && Math.abs(toX(trace.x[i]) - left) > CURSOR_REACH)) return null;
    return trace.x[i] >= this.view.x[0] && trace.x[i] <= this.view.x[1] ? i : null;
  }

  // --- drawing

  size() {
    const width = Math.max(200, this.host.clientWidth);
    return {width, height: width < NARROW ? Math.min(this.data.height, 260) : this.data.height};
  }

  build() {
    if (this.u) this.u.destroy();
    const series = this.traces.map((trace, k) => ({
                                     label: trace.name,
                                     show: trace.shown,
                                     facets: [{scale: 'x', auto: true}, {scale: 'y', auto: true}],
                                     stroke: () => traceColour(trace.colour),
                                     fill: trace.style === 'marks' ? () => colours.ground : undefined,
                                     width: trace.width,
                                     dash: traceDash(trace),
                                     paths: (u, index) => this.path(u, index - 1),
                                     points: {show: false},
                                   }));
    this.u = new uPlot(
        {
          mode: 2,
          ...this.size(),
          legend: {show: false},
          cursor: {
            drag: {x: true, y: true, uni: 20, dist: 4, setScale: false},
            dataIdx: (u, index) => this.nearest(index - 1),
            points: {size: 9, fill: (u, index) => traceColour(this.traces[index - 1].colour)},
            bind: {dblclick: () => () => (this.showWhole(), null)},
          },
          scales: {x: this.scale('x'), y: this.scale('y')},
          axes: [this.axis('x'), this.axis('y')],
          series: [null, ...series],
          hooks: {setSelect: [u => this.zoomToSelection(u)], setCursor: [() => this.cursorMoved()]},
        },
        [null, ...this.traces.map(trace => [trace.x, trace.y])], this.host);
  }

  scale(axis) {
    return {time: false, distr: this.log[axis] ? 3 : 1, range: () => [...this.view[axis]]};
  }

  axis(axis) {
    const {label, unit} = this.data[axis];
    const ticks = () => logTicks(...this.view[axis]);
    const log = {
      splits: () => ticks().at,
      filter: (u, splits) => splits.map(value => ticks().numbered.has(value) ? value : null),
    };
    return {
      ...(this.log[axis] ? log : {}),
      scale: axis,
      label,
      stroke: () => colours.text,
      grid: {stroke: () => colours.grid, width: 1},
      ticks: {stroke: () => colours.grid, width: 1},
      values: (u, splits) => splits.map(value => value === null ? '' : tickText(value, unit)),
      font: '12px Helvetica, Arial, sans-serif',
      labelFont: '12px Helvetica, Arial, sans-serif',
      labelSize: 20,
      size: axis === 'x' ? 34 : (u, texts) => 18 + 6.7 * Math.max(6, ...(texts || []).map(text => text.length)),
    };
  }

  /** Lines in the order of the samples (a loop goes back and forth), lifted over gaps; marks as rings. */
  path(u, k) {
    const trace = this.traces[k], path = new Path2D(), marks = trace.style === 'marks';
    const radius = 3.6 * devicePixelRatio;
    let down = false;
    for (let i = 0; i < trace.x.length; ++i) {
      if (!drawable(trace, i, this.log)) {
        down = false;
        continue;
      }
      const x = u.valToPos(trace.x[i], 'x', true), y = u.valToPos(trace.y[i], 'y', true);
      if (marks) path.moveTo(x + radius, y);
      if (marks)
        path.arc(x, y, radius, 0, 2 * Math.PI);
      else if (down)
        path.lineTo(x, y);
      else
        path.moveTo(x, y);
      down = true;
    }
    return {stroke: path, fill: marks ? path : null, clip: null, band: null, gaps: null, flags: 0};
  }

  zoomToSelection(u) {
    const {left, top, width, height} = u.select;
    if (width <= 0 && height <= 0) return;
    const view = {};
    if (width > 0 && width < u.over.clientWidth) view.x = [u.posToVal(left, 'x'), u.posToVal(left + width, 'x')];
    if (height > 0 && height < u.over.clientHeight) view.y = [u.posToVal(top + height, 'y'), u.posToVal(top, 'y')];
    u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    this.setView(view);
  }

  cursorMoved() {
    this.at = this.traces.map((_, k) => this.u ? this.nearest(k) : null);
    if (this.u) this.pointed(this);
  }
}
