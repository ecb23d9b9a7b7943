# suites.sh: what run.sh and soak.sh share: building, running a suite, counting. Sourced from the checkout's top.
passed=0 failed=0 skipped=0
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
mkdir -p build
log=build/test.log
: >"$log"

# Adds up the "N passed, N failed, N skipped" line that ends file $1.
count() {
    line=$(sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed, \([0-9]*\) skipped$/\1 \2 \3/p' "$1" | tail -n 1)
    if [ -z "$line" ]; then
        failed=$((failed + 1))
        tail -n 20 "$1"
        echo "FAIL: it ended without a count"
        return
    fi
    set -- $line
    passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}

# suite NAME COMMAND...: runs it, shows what failed and what was skipped, counts.
suite() {
    echo "== $1"
    shift
    "$@" >build/suite.log 2>&1
    cat build/suite.log >>"$log"
    grep -v '^ok  ' build/suite.log | tail -n 60
    count build/suite.log
}

# shared NAME TESTS: the suite of a program that can share its tests among processes, by as many as there are processors.
shared() {
    echo "== $1"
    n=0 processes=
    while [ "$n" -lt "$jobs" ]; do
        AWT_SHARE=$n/$jobs "$2" >build/suite-$n.log 2>&1 &
        processes="$processes $!"
        n=$((n + 1))
    done
    wait $processes
    n=0
    while [ "$n" -lt "$jobs" ]; do
        cat build/suite-$n.log >>"$log"
        grep -v '^ok  ' build/suite-$n.log | tail -n 60
        count build/suite-$n.log
        n=$((n + 1))
    done
}

# build ARGUMENTS...: programs and tests of one configuration; a build that fails ends everything.
build() {
    echo "== building $*"
    make --no-print-directory -j"$jobs" all tests-binary "$@" >build/make.log 2>&1 && return
    grep -v '^  [A-Z]* ' build/make.log | tail -n 40
    echo "0 passed, 1 failed"
    exit 1
}

# build_beside ARGUMENTS...: the same in the background, while suites run, for these leave much of the machine idle;
# build_joined waits for it.
build_beside() {
    echo "== building $* beside what follows"
    nice make --no-print-directory -j"$jobs" all tests-binary "$@" >build/make-beside.log 2>&1 &
    beside=$!
}

build_joined() {
    wait "$beside" && return
    grep -v '^  [A-Z]* ' build/make-beside.log | tail -n 40
    echo "0 passed, 1 failed"
    exit 1
}

finish() {
    echo "everything: $log"
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
    exit
}
