#!/bin/sh
# The tests of the FMU: builds the library and the packager, makes .venv with the pinned importers, runs everything.
# Needs a Rust toolchain and python3 with venv.
set -eu
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}

cargo build --release -p stickslip-fmu --features panic-injection --lib
cp "$target/release/libstickslip_fmu.so" "$target/release/stickslip_fmu_panics.so"
cargo build --release -p stickslip-fmu --lib --examples

[ -x .venv/bin/python ] || python3 -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r fmu/tests/requirements.txt -r fmu/loops/requirements.txt

STICKSLIP_BUILD=$(cd "$target/release" && pwd)
STICKSLIP_PANIC_LIBRARY=$STICKSLIP_BUILD/stickslip_fmu_panics.so
export STICKSLIP_BUILD STICKSLIP_PANIC_LIBRARY
.venv/bin/python -m pytest -q fmu/tests "$@"
for loop in explicit_actuator implicit_mass variable_steps sweep; do
    .venv/bin/python "fmu/loops/$loop.py"
done
