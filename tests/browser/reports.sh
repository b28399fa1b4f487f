#!/bin/sh
# reports.sh PROGRAM FOLDER SOURCE: makes a study and a case in FOLDER, writes their reports into paths with blanks and letters that
# are no ASCII, has tidy check the HTML and Chromium read it. 77: neither is installed.
set -eu
program=$1 folder=$2 source=$3
rm -rf "$folder" && mkdir -p "$folder" && cd "$folder"
cat >setup.toml <<'TOML'
schema = 1
[camera]
pixels = [128, 128]
bit_depth = 12
[camera.noise]
full_well_e = 10000
read_noise_e = 5
[lens]
focal_length_mm = 105.0
f_number = 11.0
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium.field]
kind = "sinusoid"
amplitude_kg_m3 = 0.02
wavelength_mm = 6
[target]
dot_diameter_px = 3.0
[render]
method = "rays"
rays_per_dot = 64
[correlate]
window_px = [32, 16]
uncertainty = "correlation_statistics"
TOML
cat >study.toml <<'TOML'
base = "setup.toml"
[axes]
"lens.f_number" = [8, 11, 16]
"medium.field.wavelength_mm" = [4, 6, 8, 12]
[study]
repeats = 2
TOML
run="study of stops, äöü"
"$program" sweep plan study.toml -o "$run" --quiet --device cpu >/dev/null
"$program" sweep run "$run" --quiet >/dev/null
"$program" sweep collect "$run" --no-figures --quiet >/dev/null
"$program" report "$run" -o "$run/a report.html" --quiet
"$program" render setup.toml -o case --quiet --device cpu >/dev/null
"$program" correlate case --quiet --device cpu >/dev/null
"$program" report case --quiet --device cpu
# the same frames as a measurement: without a field and without truth
mkdir measured
sed -e '/medium.field/,/wavelength_mm/d' -e 's/z_d_mm = 250.0/z_d_mm = { value = 250.0, sigma = 2.0 }/' setup.toml >measured/setup.toml
cp case/reference.tif case/flow.tif case/vectors.h5 measured/
"$program" report measured --quiet --device cpu
if command -v tidy >/dev/null; then
  for page in "$run/a report.html" case/report.html measured/report.html; do
    tidy -q -e --gnu-emacs yes "$page" 2>tidy.log || { cat tidy.log; exit 1; }
  done
fi
# Selenium is where Debian puts it
python=/usr/bin/python3
[ -x "$python" ] || python=python3
exec "$python" -B "$source/report_browser.py" "$run/a report.html" "$run/study.csv" case/report.html measured/report.html
