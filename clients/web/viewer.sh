#!/bin/sh
# viewer.sh: called by `make viewer`: awtd on a free port and the gateway before it; prints the address to open; stops both
# on Ctrl-C and whatever else happens. VIEWER_PORT: where the page is to be [8080, or any that is free].
set -eu
cd "$(dirname "$0")/../.."

state=$(mktemp -d "${TMPDIR:-/tmp}/awtd-viewer.XXXXXX")
daemon=
gateway=

stop() {
    status=$?
    trap - EXIT INT TERM HUP
    for process in $gateway $daemon; do
        kill -TERM "$process" 2>/dev/null || true
        wait "$process" 2>/dev/null || true
    done
    rm -rf "$state"
    exit "$status"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

# said FILE PATTERN PROCESS: what the program wrote after the pattern, once it has; 10 s are plenty.
said() {
    tries=0
    until text=$(sed -n "s/.*$2\([^ ]*\).*/\1/p" "$1" | head -n 1) && [ -n "$text" ]; do
        tries=$((tries + 1))
        if ! kill -0 "$3" 2>/dev/null || [ "$tries" -gt 100 ]; then
            cat "$1" >&2
            return 1
        fi
        sleep 0.1
    done
    echo "$text"
}

start_gateway() {
    node clients/web/gateway.mjs --listen "127.0.0.1:$1" --connect "$address" --token-file "$state/token" >"$state/gateway" 2>&1 &
    gateway=$!
    page=$(said "$state/gateway" "drive: " "$gateway")
}

build/release/awtd --listen 127.0.0.1:0 --state-dir "$state" >"$state/log" 2>&1 &
daemon=$!
address=$(said "$state/log" "listening on " "$daemon")
start_gateway "${VIEWER_PORT:-8080}" 2>/dev/null || { [ -z "${VIEWER_PORT:-}" ] && start_gateway 0; } || { cat "$state/gateway" >&2; exit 1; }

echo
echo "Open    $page"
echo "To look on only: $(said "$state/gateway" "view: " "$gateway")"
echo "Ctrl-C stops everything."
wait "$gateway"
