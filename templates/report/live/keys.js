// A plot under the keyboard: arrows walk along a trace and choose it, + and - zoom, 0 shows everything.

class Keys {
  /** `say` speaks a text to a screen reader. */
  constructor(plot, say) {
    Object.assign(this, {plot, say, trace: 0, sample: null});
    plot.host.addEventListener('keydown', event => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (this.press(event.key)) event.preventDefault();
    });
  }

  /** Whether the key means something here. */
  press(key) {
    const {plot} = this;
    const acts = {
      'ArrowRight': () => this.walk(1),
      'ArrowLeft': () => this.walk(-1),
      'PageDown': () => this.walk(10),
      'PageUp': () => this.walk(-10),
      'Home': () => this.walk(-Infinity),
      'End': () => this.walk(Infinity),
      'ArrowDown': () => this.choose(1),
      'ArrowUp': () => this.choose(-1),
      '+': () => plot.zoom(0.5),
      '=': () => plot.zoom(0.5),
      '-': () => plot.zoom(2),
      '0': () => plot.showWhole(),
      'Escape': () => plot.u.setCursor({left: -10, top: -10}),
    };
    if (!acts[key]) return false;
    acts[key]();
    return true;
  }

  /** Samples of the chosen trace that are in view. */
  samples() {
    const {plot} = this, trace = plot.traces[this.trace];
    const within = (value, [from, to]) => value >= from && value <= to;
    return trace.x.map((_, i) => i)
        .filter(
            i => drawable(trace, i, plot.log) && within(trace.x[i], plot.view.x) && within(trace.y[i], plot.view.y));
  }

  walk(step) {
    if (!this.plot.traces[this.trace]?.shown) this.choose(1, false);
    const samples = this.samples();
    if (samples.length === 0) return this.say('No sample of this trace is in view.');
    const now = samples.indexOf(this.sample ?? this.plot.at[this.trace]);
    const next = now < 0 && Number.isFinite(step) ? 0 : Math.min(samples.length - 1, Math.max(0, now + step));
    this.point(samples[next]);
  }

  choose(step, point = true) {
    const {traces} = this.plot, count = traces.length;
    for (let k = 1; k <= count; ++k) {
      const candidate = (this.trace + step * k + count * k) % count;
      if (!traces[candidate].shown) continue;
      const x = this.sample === null ? null : traces[this.trace].x[this.sample];
      this.trace = candidate;
      this.sample = null;
      const samples = this.samples();
      if (!point || samples.length === 0) return;
      const distance = i => x === null ? i : Math.abs(traces[candidate].x[i] - x);
      return this.point(samples.reduce((a, b) => distance(b) < distance(a) ? b : a));
    }
  }

  point(i) {
    const {plot} = this, trace = plot.traces[this.trace];
    this.sample = i;
    plot.pointAt(this.trace, i);
    this.say(`${trace.name}: ${valueText(trace.x[i], plot.data.x.unit)}, ${valueText(trace.y[i], plot.data.y.unit)}`);
  }
}
