#!/bin/sh
# The tests of the FMU: builds the command and the library, makes .venv with the pinned importers, runs everything.
# Needs a Rust toolchain, python3 with venv, and nm.
set -eu
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}

# The library that panics on request is built elsewhere, so that it is never the one that is packed: with the tests, whose
# dependencies a build of its own would compile once more.
CARGO_TARGET_DIR=$target/tests cargo test --release --workspace --all-features --no-run --quiet
# all members, so that the wheel of the Python package finds everything compiled
CARGO_TARGET_DIR=$target cargo build --release --workspace

[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r fmu/tests/requirements.txt -r fmu/loops/requirements.txt
scripts/importers_fmu.sh .venv-importers

STICKSLIP_BUILD=$(cd "$target/release" && pwd)
STICKSLIP_PANIC_LIBRARY=$(cd "$target/tests/release/deps" && pwd)/libstickslip_fmu.so
STICKSLIP_IMPORTERS=$(cd .venv-importers && pwd)
export STICKSLIP_BUILD STICKSLIP_PANIC_LIBRARY STICKSLIP_IMPORTERS
.venv/bin/python -m pytest -q fmu/tests "$@"
