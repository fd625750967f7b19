#!/bin/sh
# Builds the FMU library for old Linux systems (glibc 2.17) into <target>/release/portable, where the packager finds it.
# Installs cargo-zigbuild and zig from pinned wheels into .venv-zig.
set -eu
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
[ -x .venv-zig/bin/cargo-zigbuild ] || {
    python3 -m venv .venv-zig
    .venv-zig/bin/python -m pip install --quiet cargo-zigbuild==0.24.0 ziglang==0.17.1
}
PATH=$PWD/.venv-zig/bin:$PATH
ulimit -n 8192 2>/dev/null || true
cargo zigbuild --release --target x86_64-unknown-linux-gnu.2.17 -p stickslip-fmu --lib
mkdir -p "$target/release/portable"
cp "$target/x86_64-unknown-linux-gnu/release/libstickslip_fmu.so" "$target/release/portable/"
