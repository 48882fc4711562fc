// Where the lines of a logarithmic axis stand, for any range: uPlot's own want ranges that begin at round numbers.

const FEW_DECADES = 0.7;   // less is nearly linear
const MOST_DECADES = 12;   // more: not every decade has a number
const FULL_DECADES = 2.2;  // up to these 2 and 5 have numbers too

/** Round positions in [from, to], about `count` of them: steps of 1, 2 or 5 times a power of ten. */
function linearTicks(from, to, count) {
  const raw = (to - from) / count, decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(factor => factor * decade).find(candidate => candidate >= 0.999 * raw);
  const out = [];
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; ++k) out.push(k * step);
  return out;
}

/** {at, numbered}: every line, and those with a number. */
function logTicks(from, to) {
  const decades = Math.log10(to / from);
  if (!(decades > FEW_DECADES)) {
    const at = linearTicks(from, to, 6);
    return {at, numbered: new Set(at)};
  }
  const at = [], numbered = new Set(), stride = Math.ceil(decades / MOST_DECADES);
  for (let e = Math.floor(Math.log10(from)); e <= Math.ceil(Math.log10(to)); ++e) {
    for (let k = 1; k <= (stride === 1 ? 9 : 1); ++k) {
      const value = Number(`${k}e${e}`);
      if (value < from * (1 - 1e-9) || value > to * (1 + 1e-9)) continue;
      at.push(value);
      if (k === 1 ? e % stride === 0 : decades < FULL_DECADES && (k === 2 || k === 5)) numbered.add(value);
    }
  }
  return {at, numbered};
}
