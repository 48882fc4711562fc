// What part of an axis is shown: whole ranges, zooming about a point, on linear and logarithmic axes.

/** An axis' whole range: as the page gives it, or from the traces when it was made logarithmic or linear since. */
function wholeRange(axis, values, log) {
  if (log === axis.log) return [axis.from, axis.to];
  const shown = values.filter(value => value !== null && (!log || value > 0));
  const low = shown.reduce((a, b) => Math.min(a, b)), high = shown.reduce((a, b) => Math.max(a, b));
  if (log) return low < high ? [low, high] : [low / 2, low * 2];
  const margin = 0.03 * (high - low) || Math.abs(high) / 10 || 1;
  return [low - margin, high + margin];
}

/** `range` made `factor` times as wide about `centre`, within `whole`; never so narrow that numbers run out. */
function zoomed(range, centre, factor, whole, log) {
  const to = log ? Math.log : value => value, from = log ? Math.exp : value => value;
  const [low, high, middle] = [...range, centre].map(to);
  const least = 1e-9 * Math.max(Math.abs(low), Math.abs(high), high - low);
  const made = [middle + (low - middle) * factor, middle + (high - middle) * factor];
  if (made[1] - made[0] < least) return range;
  const [first, last] = whole.map(to);
  const out = [Math.max(first, made[0]), Math.min(last, made[1])];
  return out[1] - out[0] >= least ? out.map(from) : range;
}
