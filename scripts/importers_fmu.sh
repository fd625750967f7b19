#!/bin/sh
# Makes one virtual environment per further importer in the folder given (default .venv-importers).
set -eu
folder=${1:-$(dirname "$0")/../.venv-importers}
for package in fmu_manipulation_toolbox==2.0 libcosimpy==0.0.6 fmuloader==0.1.2rc0 ecospy==0.7.2; do
    name=$(echo "${package%%==*}" | tr _ -)
    [ -x "$folder/$name/bin/python" ] || python3 -m venv "$folder/$name"
    "$folder/$name/bin/python" -m pip install --quiet "$package"
done
