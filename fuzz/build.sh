#!/bin/sh
# Builds the targets with coverage, on stable Rust. `--target` keeps build scripts free of instrumentation.
set -eu
cd "$(dirname "$0")"
pass="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters"
RUSTFLAGS="$pass -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1" \
    exec cargo build --release --target x86_64-unknown-linux-gnu "$@"
