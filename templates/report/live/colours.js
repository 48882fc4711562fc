// The page's colours, read from its style sheet, so that canvases follow its light and its dark form.

const TRACE_COLOURS = 8;
const DASHES = [[], [2, 3], [9, 3, 2, 3]];

let colours = {};

/** Reads them anew: after the page has become dark or light. */
function readColours() {
  const style = getComputedStyle(document.documentElement);
  const get = name => style.getPropertyValue(name).trim();
  colours = {text: get('--text'), muted: get('--muted'), ground: get('--card'), grid: get('--grid')};
  colours.traces = Array.from({length: TRACE_COLOURS}, (_, i) => get(`--trace-${i}`));
}

function traceColour(number) {
  return colours.traces[number % TRACE_COLOURS];
}

/** The ninth trace has the first one's colour and another dash. */
function traceDash(trace) {
  return trace.style === 'dashed' ? [6, 4] : DASHES[Math.floor(trace.colour / TRACE_COLOURS) % DASHES.length];
}
