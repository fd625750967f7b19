#!/usr/bin/env bash
# Installs what the tests need and runs everything: format, lints, documentation, and all tests of the workspace.
# Needs a Rust toolchain; on Debian or Ubuntu the other tools are installed by apt when they are missing.
# The last line is `N passed, N failed`; the exit status is 0 only when nothing failed.
set -uo pipefail
cd "$(dirname "$0")/.."

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
    done < <(sed -nE 's/^test result: .* ([0-9]+) passed; ([0-9]+) failed;.*/\1 \2/p' "$log")
    if [ "$status" -ne 0 ] && [ "$failed" -eq "$before" ]; then
        failed=$((failed + 1))
        echo "FAILED: $name (exit status $status)"
    fi
}

documentation() {
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --exclude stickslip-fmu --no-deps --all-features --release --quiet
}

check "format" cargo fmt --all --check
check "lints" cargo clippy --workspace --exclude stickslip-fmu --all-targets --all-features --release --quiet -- -D warnings
check "documentation" documentation
suite "tests" cargo test --workspace --exclude stickslip-fmu --all-features --release --no-fail-fast

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
