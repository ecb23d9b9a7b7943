#!/bin/sh
# sanitized_load.sh FOLDER SECONDS: a daemon that was built with a sanitizer (FOLDER: where it is) under all kinds of load at
# once, for so long each: nobody is told of an error, the sanitizer finds nothing, and the daemon ends well.
# The load is made by build/release/awt-load; it is light, for the slowest sanitizer must keep up with it.
set -u
cd "$(dirname "$0")/.."
build=$1
seconds=$2
passed=0 failed=0
work=$(mktemp -d)
daemon=
trap '[ -n "$daemon" ] && kill "$daemon" 2>/dev/null; rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

say() {
    if [ "$1" = good ]; then
        echo "ok   $2"
        passed=$((passed + 1))
    else
        echo "FAIL $2"
        failed=$((failed + 1))
    fi
}

# load NAME ARGUMENTS...: a scenario to the end, without an error.
load() {
    name=$1
    shift
    build/release/awt-load --connect "$address" --token-file "$work/state/token" --no-floor --quiet --duration "$seconds" \
        --scenario "$name" "$@" >"$work/load" 2>&1
    if [ $? -eq 0 ] && grep -q '^errors: 0$' "$work/load"; then
        say good "$build under load: $name, $seconds s"
    else
        tail -n 20 "$work/load"
        say bad "$build under load: $name, $seconds s"
    fi
}

: >"$work/out"
awtd_options="--log-level warn --workers 2"
. tests/start_awtd.sh
if [ -n "$address" ]; then
    load mixed --connections 20 --forests 3 --strands 100 --style short --rate 6
    load mixed --connections 8 --forests 2 --strands 100 --style short-curly --rate 6 --deltas --motion jump --kind guides
    load churn --connections 8 --forests 2 --strands 100 --style short --rate 5
    load stream --connections 20 --forests 3 --strands 100 --style short --rate 20 --free
    kill "$daemon"
    wait "$daemon"
    code=$?
    daemon=
    if [ $code -eq 0 ] && ! grep -q -e 'Sanitizer' -e 'runtime error' "$work/log"; then
        say good "$build ends well after load"
    else
        tail -n 60 "$work/log"
        say bad "$build ends with $code after load"
    fi
else
    tail -n 20 "$work/log"
    say bad "$build does not listen"
fi
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
