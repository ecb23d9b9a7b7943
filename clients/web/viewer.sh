#!/bin/sh
# viewer.sh: called by `make viewer`: awtd on a free port and the gateway before it; prints the address to open; stops both
# on Ctrl-C and whatever else happens. VIEWER_PORT: where the page is to be [8080, or any that is free].
set -eu
cd "$(dirname "$0")/../.."

state=$(mktemp -d "${TMPDIR:-/tmp}/awtd-viewer.XXXXXX")
. clients/beside.sh

start_gateway() {
    node clients/web/gateway.mjs --listen "127.0.0.1:$1" --connect "$address" --token-file "$state/token" >"$state/gateway" 2>&1 &
    gateway=$!
    processes="$gateway $daemon"
    page=$(said "$state/gateway" "drive: " "$gateway")
}

build/release/awtd --listen 127.0.0.1:0 --state-dir "$state" >"$state/log" 2>&1 &
daemon=$!
processes=$daemon
address=$(said "$state/log" "listening on " "$daemon") || { cat "$state/log" >&2; exit 1; }
start_gateway "${VIEWER_PORT:-8080}" || { [ -z "${VIEWER_PORT:-}" ] && start_gateway 0; } || { cat "$state/gateway" >&2; exit 1; }

echo
echo "Open    $page"
echo "To look on only: $(said "$state/gateway" "view: " "$gateway")"
echo "Ctrl-C stops everything."
wait "$gateway"
