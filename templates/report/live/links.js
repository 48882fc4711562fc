// Plots whose x axes are the same show the same part of it, and the same place under the cursor.

/** Frequency axes are one over the whole page, others within their figure; null: an axis of its own. */
function linkOf(plot, figure) {
  const {unit, label} = plot.data.x;
  if (unit === 'Hz') return 'Hz';
  return unit === 's' ? `figure ${figure}, ${label}` : null;
}

class Links {
  constructor() {
    this.plots = [];
    this.frequencies = true;  // the reader may unlink those of different figures
    this.busy = false;
  }

  add(plot, figure) {
    this.plots.push({plot, figure, link: linkOf(plot, figure)});
  }

  others(plot) {
    const own = this.plots.find(one => one.plot === plot);
    if (!own || own.link === null || this.busy) return [];
    const linked = one => one.plot !== plot && one.link === own.link && (this.frequencies || one.figure === own.figure);
    return this.plots.filter(linked).map(one => one.plot);
  }

  /** Runs `act` for every linked plot; what that changes goes no further. */
  each(plot, act) {
    const others = this.others(plot);
    this.busy = true;
    for (const other of others) act(other);
    this.busy = false;
  }

  /** A plot that has nothing in the new range stays as it is; one that the range covers shows all it has. */
  follow(plot) {
    const [from, to] = plot.view.x, whole = plot.whole().x;
    const all = from <= whole[0] && to >= whole[1];
    this.each(plot, other => {
      const [first, last] = other.whole().x;
      const range = all ? [first, last] : [Math.max(first, from), Math.min(last, to)];
      if (range[0] < range[1]) other.setView({x: range}, false);
    });
  }

  point(plot) {
    this.each(plot, other => other.followX(plot.cursorX()));
  }
}
