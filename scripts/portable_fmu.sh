#!/bin/sh
# Builds the FMU library for old Linux systems (glibc 2.17) into <target>/release/portable, where the packager finds it: it
# takes the library that was built last, so the native one is brought up to date first.
# Installs cargo-zigbuild and zig from pinned wheels into .venv-zig.
set -eu
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
[ -x .venv-zig/bin/cargo-zigbuild ] || {
    python3 -m venv .venv-zig
    .venv-zig/bin/python -m pip install --quiet --disable-pip-version-check cargo-zigbuild==0.24.0 ziglang==0.17.1
}
PATH=$PWD/.venv-zig/bin:$PATH
ulimit -n 8192 2>/dev/null || true
host=$(rustc -vV | sed -n 's/^host: //p')
cargo build --release --workspace
cargo zigbuild --release --target "$host.2.17" -p stickslip-fmu --lib
mkdir -p "$target/release/portable"
# a new time: cargo keeps that of the last build
install -m 755 "$target/$host/release/libstickslip_fmu.so" "$target/release/portable/libstickslip_fmu.so"
