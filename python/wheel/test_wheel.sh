#!/bin/sh
# Tries a wheel as on a computer without gladstone: in a new virtual environment outside of the source tree, with an
# empty environment (no display, no compiler and no other program in PATH). Needs PyPI, for NumPy.
set -eu
wheel=$(realpath "$1")
script=$(realpath "$(dirname "$0")/try_wheel.py")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
${PYTHON:-python3} -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q --disable-pip-version-check "$wheel"
cd "$folder"
env -i HOME="$folder" PATH="$folder/venv/bin" "$folder/venv/bin/python" -I "$script"
