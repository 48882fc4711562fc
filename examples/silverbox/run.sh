#!/bin/sh
# Usage: examples/silverbox/run.sh DATA_FOLDER [OUTPUT_FOLDER]
# Asks what the linear model lacks; the records' source is named in the README.md next to this file.
set -e
here=$(cd "$(dirname "$0")" && pwd)
data=${1:?the folder that holds silverbox_train.csv}
out=${2:-out/silverbox}
"$here/../../build/bin/bodesmith" diagnose "$here/model.toml" --data "$data/silverbox_train.csv" --holdout "$data/silverbox_holdout.csv" -o "$out"
