#!/bin/sh
# figures.sh GLADSTONE FOLDER: draws the figures of Start and Explained that neither the demo nor a study draws.
set -eu
program=$1
folder=$2
docs=$(dirname "$0")/..
"$program" design "$docs/../studies/cases/table1.toml" --verify 0 --figures "$folder/design" > "$folder/design.txt"
cp "$folder/design/layout.png" "$docs/explained/layout.png"
"$program" design "$docs/../studies/cases/design.toml" --verify 0 --figures "$folder/map" > "$folder/map.txt"
cp "$folder/map/design_map.png" "$docs/design_map.png"
rm -f "$folder/bos.toml"
"$program" init bos -o "$folder/bos.toml"
"$program" render "$folder/bos.toml" -o "$folder/bos"
"$program" correlate "$folder/bos"
"$program" compare "$folder/bos"
cp "$folder/bos/displacement_maps.png" "$docs/start/bos.png"
