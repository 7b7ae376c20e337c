#!/bin/sh
# Fuzzes one target: ./run.sh TARGET SECONDS [more options of libFuzzer]. Finds lie in artifacts/TARGET.
set -eu
cd "$(dirname "$0")"
target=$1 seconds=$2
shift 2
case $target in
recipe) length=8000 ;;
edit) length=10000 ;;
fill | jobs) length=1500 ;;
*) length=4000 ;;
esac
dictionary=
if [ -f "dictionaries/$target.dict" ]; then dictionary=-dict=dictionaries/$target.dict; fi
mkdir -p "corpus/$target" "artifacts/$target" "seeds/$target"
# One thread each, so that several targets can be run side by side.
RAYON_NUM_THREADS=1 exec "target/x86_64-unknown-linux-gnu/release/$target" "corpus/$target" "seeds/$target" \
    -artifact_prefix="artifacts/$target/" -max_total_time="$seconds" -max_len="$length" $dictionary \
    -rss_limit_mb=1500 -malloc_limit_mb=1200 -timeout=10 -print_final_stats=1 "$@"
