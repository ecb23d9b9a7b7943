#!/bin/sh
# suite.sh BUILD: the gateway by itself, then the viewer in Chromium. What is not here is skipped, and said.
set -u
cd "$(dirname "$0")/../.."
build=$1
passed=0 failed=0 skipped=0
missing() {
    echo "skip: $1"
    echo "0 passed, 0 failed, $2 skipped"
    exit 0
}
command -v node >/dev/null 2>&1 || missing "node is not here" 10
[ -d clients/web/node_modules/ws ] || missing "the packages of clients/web are not here" 10
command -v emcc >/dev/null 2>&1 || missing "emcc is not here" 10
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! make --no-print-directory web B="$build" >"$log" 2>&1; then
    cat "$log"
    echo "0 passed, 1 failed, 0 skipped"
    exit 1
fi
for tests in tests/web/test_*.mjs; do
    node "$tests" "$build" >"$log" 2>&1
    cat "$log"
    set -- $(sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed, \([0-9]*\) skipped$/\1 \2 \3/p' "$log" | tail -n 1)
    [ $# -eq 3 ] || set -- 0 1 0
    passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
done
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed -eq 0 ]
