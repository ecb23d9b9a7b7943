#!/bin/sh
# suite.sh FOLDER: everything that reads bytes from outside, under libFuzzer for a bounded number of runs: all inputs of the
# committed corpus first, then others made of them, the same ones each time. FOLDER: where the program fuzz is.
# What fails is kept in FOLDER. To take into the corpus what `make soak` found (only what reaches something new is taken):
#     AWT_FUZZ=TARGET build/fuzz/fuzz -merge=1 -max_len=4096 tests/fuzz/corpus/TARGET build/fuzz/corpus/TARGET
set -u
cd "$(dirname "$0")/../.."
build=$1
passed=0 failed=0

# fuzz TARGET RUNS
fuzz() {
    corpus=tests/fuzz/corpus/$1
    files=$(ls "$corpus" | wc -l)
    made=$(mktemp -d) # libFuzzer writes what it finds into the first folder
    if [ "$files" -gt 0 ] && AWT_FUZZ=$1 "$build/fuzz" -runs=0 -timeout=60 -artifact_prefix="$build/fuzz-$1-" "$corpus" >"$build/fuzz-$1.log" 2>&1 &&
        AWT_FUZZ=$1 "$build/fuzz" -runs="$2" -seed=1 -timeout=60 -rss_limit_mb=2048 \
            -artifact_prefix="$build/fuzz-$1-" "$made" "$corpus" >>"$build/fuzz-$1.log" 2>&1; then
        echo "ok   fuzz_$1 ($files inputs kept, $2 runs)"
        passed=$((passed + 1))
    else
        tail -n 30 "$build/fuzz-$1.log"
        echo "FAIL fuzz_$1: the input is in $build/fuzz-$1-*, all that was said in $build/fuzz-$1.log"
        failed=$((failed + 1))
    fi
    rm -rf "$made"
}

fuzz strands 1500
fuzz hierarchy 20000
fuzz motion 5000
fuzz message 20000
fuzz snapshot 600
fuzz frame 3000
fuzz json 10000
fuzz delta 10000
fuzz session 160
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
