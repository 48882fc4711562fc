#!/bin/sh
# examples/picma/compare.sh [FOLDER]: every model on the measured piezo record, see README.md.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
data=${1:-$here}
bodesmith=${BODESMITH:-$here/../../build/bin/bodesmith}
out=${OUT:-$here/../../out/picma}
if [ ! -f "$data/picma_train.csv" ] || [ ! -f "$data/picma_holdout.csv" ]; then
  echo "picma_train.csv and picma_holdout.csv are not in $data" >&2
  exit 2
fi
mkdir -p "$out"
for delay in none find; do
  echo "delay: $delay"
  "$bodesmith" identify "$data/picma_train.csv" --model all --delay $delay --skip-s 1 \
    --holdout "$data/picma_holdout.csv" -o "$out/best_delay_$delay.toml"
done
# A reference inside the stroke: 1 Hz, 30 um peak to peak, 5 Hz ripple.
awk 'BEGIN { print "time_s,r"; for (i = 0; i <= 800; i++) { t = i * 0.005; printf "%.17g,%.17g\n", t, -97 - 14 * cos(6.283185307179586 * t) + sin(31.41592653589793 * t) } }' >"$out/reference.csv"
"$bodesmith" compensate "$out/best_delay_find.toml" --reference "$out/reference.csv" -o "$out/drive.csv"
echo "drive: $out/drive.csv"
