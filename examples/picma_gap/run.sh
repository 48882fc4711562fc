#!/bin/sh
# Usage: examples/picma_gap/run.sh DATA_FOLDER [OUTPUT_FOLDER]
# Asks what the linear model lacks; the records' source is named in the README.md next to this file.
set -e
here=$(cd "$(dirname "$0")" && pwd)
data=${1:?the folder that holds picma_train.csv}
out=${2:-out/picma_gap}
"$here/../../build/bin/bodesmith" diagnose "$here/model.toml" --data "$data/picma_train.csv" --holdout "$data/picma_holdout.csv" -o "$out"
