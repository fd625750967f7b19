#!/bin/sh
# Compiler for the fuzz targets: rustc, with coverage counters in what reads inputs (this project and the JSON reader). The linear
# algebra goes without: its branches say nothing about an input, and counting them costs most of an execution.
compiler=$1
shift
case " $* " in
    *" --crate-name stickslip "* | *" --crate-name serde_json "*)
        exec "$compiler" "$@" --cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=3 \
            -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
        ;;
esac
exec "$compiler" "$@"
