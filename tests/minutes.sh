#!/bin/sh
# minutes.sh BUILD: engine_loop for a minute at 60 and at 144 Hz, near the daemon and at the end of a line of 50 ms and jitter in
# each direction: no stall is longer than a frame. What a busy machine does to the loop, the daemon or the line (each says by how
# much it was late itself) is told apart and tried again; three times, and it is skipped.
#
# SECONDS_PLAYED: else 60. JITTER_MS: else 20.
set -u
cd "$(dirname "$0")/.."
build=${1:-build/release}
seconds=${SECONDS_PLAYED:-60}
passed=0 failed=0 skipped=0
frame_us=16667
work=$(mktemp -d /tmp/awtd-minutes-XXXXXX)
line=
. tests/start_awtd.sh
finish() {
    kill $daemon $line 2>/dev/null
    wait
    rm -rf "$work"
}
trap finish EXIT
trap 'exit 1' INT TERM HUP
[ -n "$address" ] || { echo "FAIL awtd does not listen"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }

# figure KEY: of the run's JSON.
figure() { sed -n "s/.*\"$1\": *\\([0-9]*\\).*/\\1/p" "$work/json"; }

# run RATE ADDRESS: leaves the longest stall in $stall_us, and in $cause what made it: the stream, or the machine.
run() {
    "$build/engine_loop" --connect "$2" --token-file "$work/state/token" --rate "$1" --seconds "$seconds" --json "$work/json" ||
        return 1
    by_way=$(($(figure longest_stall_by_way_us) + $(figure longest_stall_by_loss_us)))
    by_machine=$(($(figure longest_stall_by_loop_us) + $(figure longest_stall_by_daemon_us)))
    cause=stream stall_us=$by_way
    [ "$by_way" -le $frame_us ] && [ "$by_machine" -gt $frame_us ] && cause=machine stall_us=$by_machine
    return 0
}

# minute NAME RATE far|near
minute() {
    for try in 1 2 3; do
        echo "-- $1, load $(cut -d ' ' -f 1 /proc/loadavg 2>/dev/null)"
        target=$address line=
        if [ "$3" = far ]; then
            "$build/awt-relay" --connect "$address" --delay 50 --jitter "${JITTER_MS:-20}" >"$work/line" &
            line=$!
            sleep 1
            target=$(sed -n 's/^listening on //p' "$work/line")
        fi
        run "$2" "$target" || break
        if [ -n "$line" ]; then
            kill "$line"
            wait "$line"
            late_ms=$(sed -n 's/^late by \([0-9]*\).*/\1/p' "$work/line")
            echo "the line itself was late by $late_ms ms at most"
            [ "$late_ms" -lt 17 ] || cause=machine
        fi
        if [ "$stall_us" -le $frame_us ]; then
            echo "ok   $1"
            passed=$((passed + 1))
            return
        fi
        if [ "$cause" = stream ]; then
            break
        fi
    done
    if [ "${cause:-}" = machine ]; then
        echo "skip $1: each of three times the machine had no time for it"
        skipped=$((skipped + 1))
    else
        echo "FAIL $1"
        failed=$((failed + 1))
    fi
}

minute "60 Hz, near" 60 near
minute "144 Hz, near" 144 near
minute "60 Hz, 50 ms away" 60 far
minute "144 Hz, 50 ms away" 144 far
echo "$passed passed, $failed failed, $skipped skipped"
