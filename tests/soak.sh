#!/bin/sh
# soak.sh: what takes longer than make test may: every test under TSan and with the other compiler, the same bits from both compilers
# at every optimisation, and ten simulated minutes of every style in every clip. Its last line counts all.
set -u
cd "$(dirname "$0")/.."
. tests/suites.sh

build config=tsan
suite "every test, TSan" build/tsan/tests
build config=release CC=clang CXX=clang++
suite "every test, clang -O2" build/release/tests
for flags in -O0 -O1 -O3 "-O3 -march=native"; do
    build config=release CFLAGS="$flags" CXXFLAGS="$flags"
    suite "same bits, gcc $flags" build/release/tests golden
done
for flags in -O0 -O3 "-O3 -march=native"; do
    build config=release CC=clang CXX=clang++ CFLAGS="$flags" CXXFLAGS="$flags"
    suite "same bits, clang $flags" build/release/tests golden
done
build config=release
for clip in lean jump run shake; do
    echo "== ten simulated minutes, $clip"
    build/release/awt-bench paper --motion "$clip" --seconds 600 2>/dev/null || failed=$((failed + 1))
done
finish
