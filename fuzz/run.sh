#!/bin/sh
# Builds the fuzz targets with the coverage counters of libFuzzer (the stable toolchain and a C++ compiler are enough) and
# runs one of them:   sh fuzz/run.sh TARGET [arguments of libFuzzer]   e.g.   sh fuzz/run.sh state -runs=1000000
# New inputs go into fuzz/found/TARGET (not committed), crashing ones into fuzz/crashes.
set -eu
cd "$(dirname "$0")"
target=$1
shift
# longest input: longer ones only repeat what shorter ones do
case $target in
scene) longest=300 ;;
calls) longest=160 ;;
mesh) longest=6000 ;;
*) longest=48 ;;
esac
# a wrapper and no flags for all crates: it leaves the counters out of build scripts, procedural macros and the linear algebra
RUSTC_WRAPPER="$PWD/counted.sh" cargo build --release --quiet --bins
mkdir -p "found/$target" crashes
exec "target/release/$target" -artifact_prefix="crashes/$target-" -entropic=0 -reload=0 -max_len=$longest -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 "$@" "found/$target" "corpus/$target"
