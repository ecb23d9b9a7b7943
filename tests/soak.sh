#!/bin/sh
# soak.sh: what takes longer than make test may, with the time that each part took: ten simulated minutes of every style under
# the most violent motion there is, what has threads under TSan, the same bits from both compilers at every optimisation and on
# another architecture, kills at any moment, no memory anywhere, load of all kinds under the sanitizers, minutes of a game's loop,
# and fuzzing of all that reads bytes from outside. Its last line counts all.
#
# PARTS: these alone, of violence bits around minutes fuzz clang kills memory load tsan.
# AWT_DATA: where motion files are (else ../shared/data); SECONDS_SIMULATED, FUZZ_SECONDS (of each target), LOAD_SECONDS (of each
# scenario): for a shorter run.
set -u
cd "$(dirname "$0")/.."
. tests/suites.sh
data=${AWT_DATA:-../shared/data}/motion
styles="short short-curly long long-curly"
began=$(date +%s)

# How long the part took that began with the last call.
took() {
    now=$(date +%s)
    echo "   ($1: $((now - began)) s)"
    began=$now
}

# One line for what each file named says last, every 20 s, while any process of $running lives.
watch_logs() {
    while kill -0 $running 2>/dev/null; do
        sleep 20
        for file in "$@"; do
            [ -s "$file" ] && tail -n 1 "$file" | cut -c 1-150
        done
    done
}

# ---- ten minutes of violence, as many styles at once as there are processors, at most two ----

# styles_in NAME STYLE...: one after the other.
styles_in() {
    name=$1
    shift
    for style in "$@"; do
        build/release/awt-bench soak --style "$style" --seconds "${SECONDS_SIMULATED:-600}" $clips \
            >build/soak-$style.log 2>build/soak-$name.progress
    done
}

violence() {
    clips="lean jump run shake"
    if [ -d "$data" ]; then
        clips="$clips $(echo "$data"/*.bvh) $(echo "$data"/*user*.csv)"
    else
        echo "skip: no motion files in $data: only the built-in clips are tried"
        skipped=$((skipped + 1))
    fi
    echo "== ${SECONDS_SIMULATED:-600} simulated seconds of every style, the most violent motion"
    rm -f build/soak-*.log build/soak-*.progress
    if [ "$jobs" -gt 1 ]; then
        styles_in one short long &
        running=$!
        styles_in two short-curly long-curly &
        running="$running $!"
    else
        styles_in one $styles &
        running=$!
    fi
    watch_logs build/soak-one.progress build/soak-two.progress
    wait
    sed '/^[0-9]* passed/d;/ energy /d;/^FAIL/d' build/soak-short.log
    for style in $styles; do
        grep -e ' energy ' -e '^FAIL' build/soak-$style.log
        count build/soak-$style.log
    done
}

# ---- the same bits everywhere: the tests that know the very bits of hair, and the bytes of every kind of frame ----

# same_bits NAME RUNNER MAKE-ARGUMENTS...
same_bits() {
    name=$1 runner=$2
    shift 2
    rm -rf build/bits
    make --no-print-directory -j"$jobs" B=build/bits SRC_unit="$bits_tests tests/unit/test_golden_frames.c" \
        SRC_core="$bits_core $(echo core/geom/*.c core/geom/*.cc)" SRC_clients="$(echo clients/motion/*.c)" SRC_proto= \
        SRC_server= SRC_lent= WRAP= WARN="-Wall -Wextra" "$@" build/bits/tests >build/make.log 2>&1 || {
        tail -n 20 build/make.log
        echo "FAIL $name: does not build"
        failed=$((failed + 1))
        return
    }
    suite "same bits, $name" $runner build/bits/tests golden same_on_every_compiler
    fused "$name"
}

# fused NAME: whether the compiler made a*b+c one rounding, as it was told not to.
fused() {
    if ! command -v "${objdump:=objdump}" >/dev/null 2>&1; then
        skipped=$((skipped + 1))
        echo "skip: no $objdump here"
        return
    fi
    found=$("$objdump" -d build/bits/libawt.a | grep -c -e 'vfn*m[a-z]*1*[0-9]*[ps][sd]' -e 'fn*m\(add\|sub\|la\|ls\)[[:space:]]')
    if [ "$found" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $1: $found fused multiply-adds in libawt.a"
    fi
}

all_bits() {
    bits_tests="tests/main.c tests/unit/test_golden.c tests/unit/test_styles.c tests/unit/fixture.c"
    bits_core=$(echo core/base/*.c core/groom/*.c core/sim/*.c)
    for flags in -O0 -O1 -O2 -O3 "-O3 -march=native"; do
        same_bits "gcc $flags" "" CC=gcc CXX=g++ CFLAGS="$flags" CXXFLAGS="$flags"
    done
    for flags in -O0 -O2 -O3 "-O3 -march=native"; do
        same_bits "clang $flags" "" CC=clang CXX=clang++ CFLAGS="$flags" CXXFLAGS="$flags"
    done
    # Without frames: they need libraries in C++ of that machine.
    if command -v aarch64-linux-gnu-gcc >/dev/null 2>&1 && command -v qemu-aarch64 >/dev/null 2>&1; then
        objdump=aarch64-linux-gnu-objdump
        same_bits "aarch64 gcc -O2, under qemu" qemu-aarch64 CC=aarch64-linux-gnu-gcc CXX=aarch64-linux-gnu-gcc LDFLAGS=-static \
            SRC_unit="$bits_tests" SRC_core="$bits_core" LDLIBS_ALL="-lm -pthread"
    else
        echo "skip: no aarch64 compiler or no qemu-aarch64 here"
        skipped=$((skipped + 1))
    fi
}

# ---- fuzzing ----

fuzzer() {
    echo "== building config=fuzz"
    make --no-print-directory -j"$jobs" config=fuzz CC=clang CXX=clang++ build/fuzz/fuzz >build/make.log 2>&1 && return
    grep -v '^  [A-Z]* ' build/make.log | tail -n 40
    echo "0 passed, 1 failed"
    exit 1
}

# fuzz TARGET: begins from seeds made here, and from what earlier runs found.
fuzz() {
    corpus=build/fuzz/corpus/$1
    mkdir -p "$corpus"
    echo "== fuzzing: $1, ${FUZZ_SECONDS:-60} s"
    if AWT_FUZZ=$1 AWT_FUZZ_SEEDS=$corpus build/fuzz/fuzz >build/fuzz/$1.log 2>&1 &&
        AWT_FUZZ=$1 build/fuzz/fuzz -max_total_time="${FUZZ_SECONDS:-60}" -timeout=20 -rss_limit_mb=2048 \
            -artifact_prefix=build/fuzz/$1- "$corpus" >>build/fuzz/$1.log 2>&1; then
        tail -n 1 build/fuzz/$1.log
        passed=$((passed + 1))
    else
        tail -n 30 build/fuzz/$1.log
        echo "FAIL: the input is in build/fuzz/$1-*, all it said in build/fuzz/$1.log"
        failed=$((failed + 1))
    fi
}

# ---- the parts ----

part_violence() {
    violence
    took "the most violent motion"
}

part_bits() {
    all_bits
    took "same bits"
}

part_around() {
    suite "behind TLS" sh tests/tls.sh build/release
    suite "in a container" sh tests/container.sh
    took "TLS and container"
}

part_minutes() {
    suite "minutes of a game's loop" sh tests/minutes.sh build/release
    took "minutes of a game's loop"
}

part_fuzz() {
    fuzzer
    for target in strands hierarchy motion message snapshot frame json delta session; do
        fuzz "$target"
    done
    took fuzzing
}

part_clang() {
    build config=release CC=clang CXX=clang++ B=build/clang
    suite "every test, clang -O2" build/clang/tests
    took "every test, clang"
}

part_kills() {
    AWT_KILLS=200 AWT_SEEDS=3000 suite "200 kills at any moment, 3,000 interleavings" build/release/tests killed interleave
    took "kills and interleavings"
}

part_load() {
    build config=asan CC=clang CXX=clang++
    suite "load of all kinds, ASan and UBSan" sh tests/sanitized_load.sh build/asan "${LOAD_SECONDS:-60}"
    build config=tsan
    suite "load of all kinds, TSan" sh tests/sanitized_load.sh build/tsan "${LOAD_SECONDS:-60}"
    took "load under the sanitizers"
}

part_memory() {
    build config=asan CC=clang CXX=clang++
    AWT_ALLOCATIONS=1 suite "every allocation of the daemon failed once, ASan and UBSan" build/asan/tests without_memory
    took "out of memory"
}

part_tsan() {
    build config=tsan
    suite "every test with more than one thread, TSan" build/tsan/tests server client_ e2e bench_ gusts_ worker
    took "TSan"
}

build config=release
took building
for part in ${PARTS:-violence bits around minutes fuzz clang kills memory load tsan}; do
    part_$part
done
finish
