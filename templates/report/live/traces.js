// A trace: one curve or set of marks with its own x values. Finding the sample that a reader points at.

/** Whether values never fall. */
function isSorted(values) {
  return values.every((value, i) => i === 0 || value === null || values[i - 1] === null || value >= values[i - 1]);
}

/** The traces of a plot as figure_data.js hands them over: columns are shared between traces. */
function makeTraces(plot, columns) {
  return plot.traces.map(trace => {
    const x = columns[trace.x];
    return {...trace, x, sorted: isSorted(x), name: trace.name || plot.y.label || plot.title};
  });
}

/** Whether sample i can be shown on axes of which some are logarithmic. */
function drawable(trace, i, log) {
  const x = trace.x[i], y = trace.y[i];
  return x !== null && y !== null && !(log.x && x <= 0) && !(log.y && y <= 0);
}

/** The drawable sample nearest to `x` (distance by `toPixel`), from a sorted trace; null: there is none. */
function nearestInX(trace, x, toPixel, log) {
  let low = 0, high = trace.x.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (trace.x[middle] < x)
      low = middle;
    else
      high = middle;
  }
  const at = toPixel(x);
  const distance = i => Math.abs(toPixel(trace.x[i]) - at);
  // From the two neighbours outwards over gaps.
  for (let step = 0; step < trace.x.length; ++step) {
    const found = [low - step, high + step].filter(i => i >= 0 && i < trace.x.length && drawable(trace, i, log));
    if (found.length > 0) return found.reduce((a, b) => distance(b) < distance(a) ? b : a);
  }
  return null;
}

/** The drawable sample nearest to a point of the screen; null: none within `reach` pixels. */
function nearestInPlane(trace, left, top, toPixelX, toPixelY, log, reach) {
  let best = null, least = reach * reach;
  for (let i = 0; i < trace.x.length; ++i) {
    if (!drawable(trace, i, log)) continue;
    const dx = toPixelX(trace.x[i]) - left, dy = toPixelY(trace.y[i]) - top;
    if (dx * dx + dy * dy < least) [best, least] = [i, dx * dx + dy * dy];
  }
  return best;
}
