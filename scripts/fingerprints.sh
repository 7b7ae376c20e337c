#!/usr/bin/env bash
# A SHA-256 of the result of every command of README.md and docs/gallery.md, without its recipe, for the program given:
#   scripts/fingerprints.sh target/release/arabesque > before.txt
# Two versions of the program make the same pictures when their lists are the same.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(realpath "${1:?usage: scripts/fingerprints.sh PROGRAM}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

grep -hE '^arabesque (fill|ribbon) ' README.md docs/gallery.md | grep -v -- --variations | sort -u | while read -r line; do
    arguments=${line#arabesque }
    out=${arguments##*-o }
    # Word splitting is meant: the commands of the documents have no quotes.
    # shellcheck disable=SC2086
    "$program" ${arguments% -o *} --no-recipe --quiet -o "$folder/$out"
    printf '%s  %s\n' "$(sha256sum <"$folder/$out" | cut -d' ' -f1)" "$line"
done
