#!/usr/bin/env bash
# Installs what the tests need and runs everything: format, lints, documentation, all tests of the workspace, the FMU in its
# importers, and the Python package. Builds with all features go into target/tests, so that what users run is never a test build.
# Needs a Rust toolchain; on Debian or Ubuntu the other tools are installed by apt when they are missing.
# The last line is `N passed, N failed`; the exit status is 0 only when nothing failed.
set -uo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}

passed=0
failed=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# tool -> Debian package
declare -A packages=([gcc]=gcc [g++]=g++ [clang]=clang [clang++]=clang [make]=make [cmake]=cmake [pkg-config]=pkg-config
    [valgrind]=valgrind [python3]=python3 [nm]=binutils)
missing=()
for tool in "${!packages[@]}"; do
    command -v "$tool" >/dev/null || missing+=("${packages[$tool]}")
done
python3 -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3-venv)
# the importer ecospy links it
/sbin/ldconfig -p | grep -q 'libtbb\.so\.12' || missing+=(libtbb12)
if [ ${#missing[@]} -gt 0 ]; then
    as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    echo "installing: ${missing[*]}"
    "${as_root[@]}" apt-get update -qq && DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null || {
        echo "cannot install ${missing[*]}"
        failed=$((failed + 1))
    }
fi

# Runs a check that counts as one test.
check() {
    local name=$1
    shift
    echo "== $name"
    if "$@"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $name"
    fi
}

# Passed and failed in the log, one line per summary of cargo or pytest; a pytest error is a failure.
counts() {
    sed -nE 's/^test result: .* ([0-9]+) passed; ([0-9]+) failed;.*/\1 \2/p' "$log"
    awk '/^(=+ )?[0-9]+ (passed|failed|error|skipped).* in [0-9.]+s/ {
        ok = bad = 0
        for (i = 2; i <= NF; i++) {
            if ($i ~ /^passed/) ok += $(i - 1)
            if ($i ~ /^(failed|error)/) bad += $(i - 1)
        }
        print ok, bad
    }' "$log"
}

# Runs a test runner and adds up what it reports.
suite() {
    local name=$1
    shift
    echo "== $name"
    "$@" 2>&1 | tee "$log"
    local status=${PIPESTATUS[0]} before=$failed
    while read -r ok bad; do
        passed=$((passed + ok))
        failed=$((failed + bad))
    done < <(counts)
    if [ "$status" -ne 0 ] && [ "$failed" -eq "$before" ]; then
        failed=$((failed + 1))
        echo "FAILED: $name (exit status $status)"
    fi
}

documentation() {
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --all-features --release --quiet
}

export CARGO_TARGET_DIR=$target/tests
check "format" cargo fmt --all --check
check "lints" cargo clippy --workspace --all-targets --all-features --release --quiet -- -D warnings
check "documentation" documentation
suite "tests" cargo test --workspace --all-features --release --no-fail-fast
CARGO_TARGET_DIR=$target check "FMU library for old systems" sh scripts/portable_fmu.sh
CARGO_TARGET_DIR=$target suite "FMU" sh scripts/test_fmu.sh
CARGO_TARGET_DIR=$target suite "Python" sh scripts/test_python.sh

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
