// Numbers with their units: for people with SI prefixes, for CSV files with the unit at the end of the column's name.

const PREFIXES = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p']];
const PREFIXED_UNITS = new Set(['Hz', 's', 'V', 'A', 'm', 'Ω', 'F']);
const COLUMN_UNITS = new Map([
  ['Hz', 'hz'],
  ['s', 's'],
  ['dB', 'db'],
  ['degrees', 'deg'],
  ['V', 'v'],
  ['A', 'a'],
  ['m', 'm'],
  ['Ω', 'ohm'],
  ['F', 'f'],
  ['rad/s', 'rad_s'],
  ['% of range', 'percent'],
  ['% of the fundamental', 'percent'],
  ['%', 'percent'],
]);

/** 0.00012345 as 1.2345e-4, 12.5 as 12.5: at most `digits` significant ones. */
function numberText(value, digits = 5) {
  if (value === null || !Number.isFinite(value)) return 'no value';
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-3)) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${Number(mantissa)}e${Number(exponent)}`;
  }
  return String(Number(value.toPrecision(digits)));
}

/** 12345 and 'Hz' as 12.345 kHz; -3.21 and 'dB' as -3.21 dB. */
function valueText(value, unit, digits = 5) {
  if (value === null || !Number.isFinite(value) || unit === '') return numberText(value, digits);
  if (!PREFIXED_UNITS.has(unit) || value === 0) return `${numberText(value, digits)} ${unit}`;
  // Rounded first: 999.9999 Hz is 1 kHz.
  const size = Math.abs(Number(value.toPrecision(digits)));
  const [factor, prefix] = PREFIXES.find(([least]) => size >= least) || PREFIXES[PREFIXES.length - 1];
  return `${Number((value / factor).toPrecision(digits))} ${prefix}${unit}`;
}

/** A tick of an axis: many hertz with prefixes, without the unit, which the axis' label says. */
function tickText(value, unit) {
  if (unit !== 'Hz' || Math.abs(value) < 1000) return numberText(value, 6);
  return valueText(value, unit, 6).slice(0, -2).replace(' ', '');
}

/** 'FPAA with holds' and 'dB' as fpaa_with_holds_db. */
function columnName(name, unit) {
  const plain = name.toLowerCase().replace(/[^a-z0-9]+/g, '_').replace(/^_|_$/g, '');
  const ending = COLUMN_UNITS.get(unit);
  if (!ending || plain === ending) return plain || ending || 'value';
  return plain.endsWith(`_${ending}`) ? plain : `${plain}_${ending}`;
}
