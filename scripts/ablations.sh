#!/bin/sh
# What each component of the engine for curves is good for: fills a page from each exemplar with everything, and again with one
# component switched off, and lays the results out on one sheet. docs/ablations.md says what to see.
#
#   scripts/ablations.sh [-o FOLDER] [-s SIZE] [-n SEED] [-i START] [-m on|off] [-g on|off] [EXEMPLAR.svg ...]
#
#   -o FOLDER  where the results go; default: ablations
#   -s SIZE    size of the pages; default: 400x400
#   -n SEED    seed of every run; default: 1
#   -i START   first layout of every run: patch-copy, random-copy or white-noise; default: random-copy, since patches chosen to agree
#              leave the rest little to do
#   -m on|off  whether dangling ends are mended at the end, which hides part of what goes wrong before; default: off
#   -g on|off  whether a start in disorder is grown anew, which hides what the start was; default: off
#
# Exemplars default to four of examples/. Results are FOLDER/NAME-VARIANT.svg and FOLDER/sheet.png, one row an exemplar.
# Runs from the root of the repository; builds the program first, unless ARABESQUE names one and SHEET names the sheet maker
# (crates/arabesque/examples/sheet.rs).
set -eu

folder=ablations size=400x400 seed=1 start=random-copy mending=off regrowth=off
while getopts o:s:n:i:m:g: option; do
    case $option in
        o) folder=$OPTARG ;;
        s) size=$OPTARG ;;
        n) seed=$OPTARG ;;
        i) start=$OPTARG ;;
        m) mending=$OPTARG ;;
        g) regrowth=$OPTARG ;;
        *) sed -n '5,13p' "$0" >&2; exit 2 ;;
    esac
done
shift $((OPTIND - 1))
if [ $# -eq 0 ]; then
    set -- examples/quatrefoil.svg examples/trellis.svg examples/basket.svg examples/lace.svg
fi

target=${CARGO_TARGET_DIR:-target}
if [ -z "${ARABESQUE:-}" ]; then
    cargo build --release -p arabesque-cli
    ARABESQUE=$target/release/arabesque
fi
if [ -z "${SHEET:-}" ]; then
    cargo build --release -p arabesque --example sheet
    SHEET=$target/release/examples/sheet
fi
mkdir -p "$folder"

# The label of a variant, and what it sets.
variants='everything
no orientation:orientations=off
no edge term:edges=off
hard matching:matching=hard
no existence:existence=fixed
white noise:initialisation=white-noise
enhanced Ma 2011:matching=hard,edges=off,existence=fixed'

# Words of the sheet, one a line, so that names may hold blanks.
cells=$folder/sheet.txt
: > "$cells"
for exemplar; do
    name=$(basename "$exemplar" .svg)
    printf '%s\n' "$exemplar=$name" >> "$cells"
    printf '%s\n' "$variants" | while IFS=: read -r label settings; do
        result=$folder/$name-$(printf '%s' "$label" | tr 'A-Z ' 'a-z-').svg
        arguments=$(printf '%s' "$settings" | tr ',' '\n' | sed 's/^/--set /')
        # The settings are words without blanks, to be split.
        # shellcheck disable=SC2086
        "$ARABESQUE" fill "$exemplar" --size "$size" --seed "$seed" --set "initialisation=$start" \
            --set "mending=$mending" --set "regrowth=$regrowth" $arguments \
            -o "$result" < /dev/null
        printf '%s\n' "$result=$label" >> "$cells"
    done
done

columns=$(($(printf '%s\n' "$variants" | wc -l) + 1))
set -- "$folder/sheet.png" "$columns"
while IFS= read -r cell; do
    set -- "$@" "$cell"
done < "$cells"
"$SHEET" "$@"
rm -f "$cells"
echo "$folder/sheet.png"
