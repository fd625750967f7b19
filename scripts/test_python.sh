#!/bin/sh
# The tests of the Python package: makes .venv with the pinned tools, installs the package as `pip install .` does, checks the
# types and runs everything, the examples of docstrings and of docs/python.md included.
# Needs a Rust toolchain and python3 (3.11 or newer) with venv.
set -eu
cd "$(dirname "$0")/.."
CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
export CARGO_TARGET_DIR

[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r python/tests/requirements.txt
# maturin is looked for there
PATH=$PWD/.venv/bin:$PATH
export PATH
# without isolation: an interpreter of its own for every build would have the bindings compiled anew
.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps .
.venv/bin/python -m mypy
.venv/bin/python -m pytest -q python/tests "$@"
