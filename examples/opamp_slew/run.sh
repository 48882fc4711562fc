#!/bin/sh
# Usage: examples/opamp_slew/run.sh DATA_FOLDER [OUTPUT_FOLDER]
# Asks what the linear model lacks; the records' source is named in the README.md next to this file.
set -e
here=$(cd "$(dirname "$0")" && pwd)
data=${1:?the folder that holds opamp_square.csv}
out=${2:-out/opamp_slew}
"$here/../../build/bin/bodesmith" diagnose "$here/model.toml" --data "$data/opamp_square.csv"  -o "$out"
