#!/bin/sh
# Builds the fuzz targets with the coverage counters of libFuzzer (the stable toolchain and a C++ compiler are enough) and
# runs one of them:   sh fuzz/run.sh TARGET [arguments of libFuzzer]   e.g.   sh fuzz/run.sh state -runs=1000000
# New inputs go into fuzz/found/TARGET (not committed), crashing ones into fuzz/crashes.
set -eu
cd "$(dirname "$0")"
target=$1
shift
counters="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares"
# --target keeps the counters out of build scripts and procedural macros
host=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS="--cfg fuzzing -Ccodegen-units=1 $counters" cargo build --release --quiet --target "$host" --bin "$target"
mkdir -p "found/$target" crashes
exec "target/$host/release/$target" -artifact_prefix="crashes/$target-" -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 "$@" "found/$target" "corpus/$target"
