#!/bin/sh
# service.sh: what the service is to reach, measured: awtd beside a bare poll() server in the same run, so that every
# figure is a ratio. Prints a table of what was seen, what is aimed at, and whether it was met. It judges nothing else: its
# exit code is 0 unless a measurement failed. Usage: service.sh [FOLDER OF THE PROGRAMS]. SECONDS_EACH (10): of awtd in each
# run, and as long of the bare server; ONLY=N: point N alone.
set -u
cd "$(dirname "$0")/../.."
build=${1:-build/release}
seconds=${SECONDS_EACH:-10}
work=$(mktemp -d)
table=$work/table
daemon=
failed=0
: >"$table"
trap 'stop; rm -rf "$work"' EXIT
trap 'exit 1' INT TERM

stop() {
    [ -n "$daemon" ] && kill "$daemon" 2>/dev/null && wait "$daemon" 2>/dev/null
    daemon=
}

# The greatest number of connections that this awtd takes.
connections=4096
"$build/awtd" --max-connections 16384 --version >/dev/null 2>&1 && connections=16384

# start: a daemon of our own; sets `daemon` and `address`.
start() {
    awtd_options="--max-connections $connections --max-forests 4096 --log-level warn"
    . tests/start_awtd.sh
    [ -n "$address" ] && return
    echo "awtd does not listen:"
    cat "$work/log"
    exit 1
}

# load NAME ARGUMENTS...: one run of awt-load; its table goes to $work/NAME and to us.
load() {
    name=$1 busy=
    shift
    echo
    "$build/awt-load" --connect "$address" --token-file "$work/state/token" --duration "$seconds" "$@" >"$work/$name" 2>"$work/$name.err"
    code=$?
    cat "$work/$name"
    busy=
    fit "$name" || busy=yes
    [ -s "$work/$name" ] && return
    tail -n 1 "$work/$name.err"
    [ $code -eq 0 ] || failed=1
    return 1
}

# The figure of row $2 ("awtd / bare") in run $1; columns: came p50 p90 p99 p99.9 p99.99 max.
figure() {
    awk -v row="$2" -v column="$3" '
        BEGIN { place["came"] = 1; place["p50"] = 2; place["p90"] = 3; place["p99"] = 4; place["p99.9"] = 5 }
        index($0, row " ") == 1 {
            $0 = substr($0, 17)
            print $(row ~ / \/ / ? place[column] : place[column] + 1)
        }' "$work/$1"
}

# fit NAME: whether the machine could carry that load at all: no more than 2 % of the bare server's requests went out late.
fit() {
    awk -v seconds="$seconds" '
        index($0, "bare poll() ") == 1 { due = $3 * seconds * 0.9 }
        /^sent late/ { late = $9 }
        END { exit !(late <= 0.02 * due) }' "$work/$1"
}

# see POINT WHAT MEASURED "<=" AIM: a line of the table. An empty measurement is said to be one.
see() {
    awk -v point="$1" -v what="$2" -v value="$3" -v sign="$4" -v aim="$5" -v busy="$busy" 'BEGIN {
        met = value == "" || value == "-" ? "not measured" : busy != "" ? "says nothing: the machine was too busy for this load" : (sign == "<=" ? value + 0 <= aim + 0 : value + 0 >= aim + 0) ? "met" : "NOT MET"
        printf "%-5s %-62s %10s  %s %-6s %s\n", point, what, value == "" ? "-" : value, sign, aim, met
    }' >>"$table"
}

wanted() {
    [ -z "${ONLY:-}" ] || [ "$ONLY" = "$1" ]
}

# link RTT SHARE: four heads at 30 frames a second, watched over a link of that round trip, ms, which carries SHARE times
# the bytes that they need. What it can carry must come, and no frame be older on arrival than the way and two of its
# own transfers.
link() {
    fps=$(awk -v share="$2" 'BEGIN { printf "%.1f", share < 1 ? 30 * share : 30 }')
    rate=$(awk -v bytes="$frame_bytes" -v share="$2" 'BEGIN { printf "%d", 30 * bytes * share }')
    # a frame more than are under way until the first one's credit is back: the round trip and its own transfer
    credit=$(awk -v rtt="$1" -v fps="$fps" -v share="$2" 'BEGIN { c = rtt * fps / 1000 + fps / (30 * share); printf "%d", 1 + c + (c > int(c)) }')
    "$build/awt-relay" --listen 127.0.0.1:0 --connect "$address" --delay $(($1 / 2)) --rate "$rate" >"$work/relay" &
    relay=$!
    sleep 0.5
    "$build/awt-load" --connect "$(sed -n 's/^listening on //p' "$work/relay")" \
        --token-file "$work/state/token" --duration "$seconds" --scenario stream --free --no-floor --forests 4 --connections 4 \
        --rate 30 --credit "$credit" --quiet >"$work/link" 2>&1
    kill "$relay" 2>/dev/null
    wait "$relay" 2>/dev/null
    echo "round trip $1 ms, $2 of the bytes needed (a window of $credit): $(figure link awtd came) frames a second of $(figure link awtd offered), p99 of their age $(figure link 'age of frames' p99) us"
    see 4 "link of $1 ms that carries $2 of what is needed: frames, Hz" "$(awk -v c="$(figure link awtd came)" 'BEGIN { if (c > 0) printf "%.1f", c / 4 }')" \
        ">=" "$(awk -v fps="$fps" 'BEGIN { printf "%.1f", 0.97 * fps }')"
    see 4 "  and the p99 of their age, ms" "$(awk -v a="$(figure link 'age of frames' p99)" 'BEGIN { if (a > 0) printf "%.1f", a / 1000 }')" \
        "<=" "$(awk -v rtt="$1" -v rate="$rate" -v bytes="$frame_bytes" 'BEGIN { printf "%.1f", rtt / 2 + 2000 * bytes / rate }')"
}

start

if wanted 1; then
    load ping --scenario query --connections 1 --forests 1 --closed &&
        see 1 "query of a ready 20 KB frame, one connection: p50, awtd / bare" "$(figure ping 'awtd / bare' p50)" "<=" 1.15
    load idle --scenario idle --connections 300 --rate 20 --idle 10000 &&
        see 1 "300 ask, $(sed -n 's/.* and \([0-9]*\) idle ones.*/\1/p' "$work/idle") idle: p50, with / without them" \
            "$(figure idle 'laden / awtd' p50)" "<=" 1.3
fi
if wanted 2; then
    load many --scenario query --connections 300 --rate 60 &&
        see 2 "300 connections, 60 Hz, open loop: p99, awtd / bare" "$(figure many 'awtd / bare' p99)" "<=" 3
    load more --scenario query --connections 1000 --rate 20 &&
        see 2 "1,000 connections, 20 Hz, open loop: p99, awtd / bare" "$(figure more 'awtd / bare' p99)" "<=" 4
fi
if wanted 3; then
    load throughput --scenario query --connections 64 --closed &&
        see 3 "throughput at 64 connections: answers a second, awtd / bare" \
            "$(figure throughput 'awtd / bare' came)" ">=" 0.8
    load fan --scenario stream --connections 64 --forests 1 --closed --motion still --credit 32 &&
        see 3 "fan-out of a 20 KB frame to 64: frames a second, awtd / bare" "$(figure fan 'awtd / bare' came)" ">=" 0.8
fi
if wanted 4; then
    echo
    "$build/awt-load" --connect "$address" --token-file "$work/state/token" --duration 2 --scenario stream --no-floor --connections 4 \
        --forests 4 --rate 30 --quiet >"$work/frames"
    frame_bytes=$(sed -n 's/.*; \([0-9]*\) bytes each.*/\1/p' "$work/frames")
    busy=
    for share in 1.5 0.5; do
        for round_trip in 20 100 200; do
            link $round_trip $share
        done
    done
    load slow --scenario slow-viewer --duration 20 &&
        see 4 "a tenth of the viewers stalled: the others' p99, with / without" \
            "$(sed -n 's/.*median of .* pairs: //p' "$work/slow")" "<=" 1.10
fi
if wanted 5; then
    load quiet --scenario query --connections 64 --rate 20
    quiet_busy=$busy
    "$build/awt-load" --connect "$address" --token-file "$work/state/token" --quiet --no-floor --scenario stream --closed \
        --style long-curly --strands 10000 --motion run --forests 8 --connections 8 --duration "$((3 * seconds + 60))" \
        >/dev/null 2>&1 &
    saturating=$!
    sleep 15 # until the heads are there
    load loud --scenario query --connections 64 --rate 20 && busy=$quiet_busy && # beside busy workers late is what it is about
        see 5 "workers saturating all cores: p99 of ready frames, busy / quiet" \
            "$(awk -v a="$(figure loud awtd p99)" -v b="$(figure quiet awtd p99)" 'BEGIN { if (b > 0) printf "%.2f", a / b }')" "<=" 2
    echo "(the bare server's own p99 beside busy workers / beside quiet ones: $(awk -v a="$(figure loud 'bare poll()' p99)" \
        -v b="$(figure quiet 'bare poll()' p99)" 'BEGIN { if (b > 0) printf "%.2f", a / b }'))"
    kill "$saturating" 2>/dev/null
    wait "$saturating" 2>/dev/null
fi

# Sets `spent` to the processor seconds that programs of ours which have ended took; a shell of its own would have none.
count_spent() {
    times >"$work/times"
    spent=$(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, "m"); s += 60 * t[1] + t[2] } printf "%.2f", s }' "$work/times")
}

# How many heads of the long style run freely: more each time, until frames stay away: less than 97 % of 60 a second from
# those that move and 4 from those at rest, which have fallen asleep before anything is counted. Sets `held`, and `viewers`
# to the processors that whoever watched so many took; says what gave way first. Usage: heads SHARE CLIP SETTLE, s.
heads() {
    held=0 viewers=0
    for count in 4 8 12 16 20 24 32 48 64 96 128 192 256; do # a connection opens no more
        count_spent
        before=$spent
        "$build/awt-load" --connect "$address" --token-file "$work/state/token" --quiet --settle "$3" --duration 5 --scenario stream --free \
            --strands 10000 --rate 60 --forests $count --connections $count --moving "$1" --motion "$2" >"$work/heads" 2>&1
        came=$(awk -v moving="$1" -v count=$count 'index($0, "awtd ") == 1 && $2 > 0 {
            moves = int(moving * count) + (moving * count > int(moving * count))
            print $3 / (60 * moves + 4 * (count - moves))
        }' "$work/heads")
        if [ -z "$came" ]; then
            tail -n 1 "$work/heads"
            return
        fi
        echo "$count heads, $1 moving ($2): $(awk -v s="$came" 'BEGIN { printf "%.1f", 100 * s }') % of the frames came, p99 $(figure heads awtd p99) us after what they show; $(sed -n 's/.*frames left out/left out/p' "$work/heads")"
        awk -v s="$came" 'BEGIN { exit s >= 0.97 }' && return
        held=$count
        count_spent
        viewers=$(awk -v s="$(($3 + 5))" -v a="$before" -v b="$spent" 'BEGIN { printf "%.2f", (b - a) / s }')
    done
}

if wanted 6; then
    echo
    "$build/awt-bench" capacity >"$work/capacity" 2>/dev/null
    sed -n '/frames of/,$p' "$work/capacity"
    cores=$(getconf _NPROCESSORS_ONLN)
    set -- $(awk '/^long / && /[|].*[|]/ { print $(NF - 2), $(NF - 1), $NF }' "$work/capacity")
    for share in 0 0.1 1; do
        settle=15
        [ $share = 1 ] && settle=3
        heads $share lean-forever $settle
        echo "long style, $share of the heads moving: $held held on $cores cores, of which their viewers took $viewers; the cost model says ${1:-?} a core: $(awk -v a="${1:-0}" -v c="$cores" -v v="$viewers" 'BEGIN { s = 0.8 * c; printf "%d", a * (c - v < s ? c - v : s) }')"
        [ $# -gt 0 ] && shift
    done
    heads 1 jump 3
    echo "all heads jumping at once: $held held on $cores cores, of which their viewers took $viewers"
fi

stop
echo
echo "point what                                                             measured  aim"
cat "$table"
exit $failed
