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

# run_shares TESTS LOG: a program whose tests can be shared, in more shares than there are processors, so that none of these
# is without work while another has much left.
shares=$((8 * jobs))
run_shares() {
    rm -f build/"$2"-*.log
    n=0
    while [ "$n" -lt "$shares" ]; do
        echo "$n"
        n=$((n + 1))
    done | xargs -P "$jobs" -I '{}' sh -c 'AWT_SHARE={}/"$0" "$1" >build/"$2"-{}.log 2>&1' "$shares" "$1" "$2"
    return 0 # what failed is in the logs
}

# tell_shares LOG: shows and counts what they wrote.
tell_shares() {
    before="$passed $failed $skipped"
    n=0
    while [ "$n" -lt "$shares" ]; do
        cat build/"$1"-$n.log >>"$log"
        grep -v -e '^ok  ' -e '^[0-9]* passed, [0-9]* failed, [0-9]* skipped$' build/"$1"-$n.log | tail -n 60
        count build/"$1"-$n.log
        n=$((n + 1))
    done
    set -- $before
    echo "$((passed - $1)) passed, $((failed - $2)) failed, $((skipped - $3)) skipped"
}

# shared NAME TESTS: the suite of a program that can share its tests.
shared() {
    echo "== $1"
    run_shares "$2" suite
    tell_shares suite
}

# build ARGUMENTS...: programs and tests of one configuration; a build that fails ends everything.
build() {
    echo "== building $*"
    make --no-print-directory -j"$jobs" all tests-binary "$@" >build/make.log 2>&1 && return
    grep -v '^  [A-Z]* ' build/make.log | tail -n 40
    echo "0 passed, 1 failed"
    exit 1
}

# shared_beside NAME TESTS ARGUMENTS...: builds that configuration and runs its tests, in the background, while suites run
# that leave much of the machine idle; shared_joined waits for them, shows and counts.
shared_beside() {
    beside=$1 tests_beside=$2
    shift 2
    echo "== building $* and running its tests beside what follows"
    rm -f build/beside-*.log
    {
        nice make --no-print-directory -j"$jobs" all tests-binary "$@" >build/make-beside.log 2>&1 &&
            run_shares "$tests_beside" beside
    } &
    process_beside=$!
}

shared_joined() {
    echo "== $beside"
    if wait "$process_beside"; then
        tell_shares beside
        return
    fi
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
