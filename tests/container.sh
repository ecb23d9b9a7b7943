#!/bin/sh
# container.sh: builds docker/Dockerfile with buildah, runs awtd of it as the user that it names, and asks whether it lives, as
# the image's own health check does. Everything is kept in one folder, and removed. Skips where there is no buildah.
# DEBIAN_BASE: a folder with a Debian 12 (debootstrap --variant=minbase), where no registry can be reached.
set -u
cd "$(dirname "$0")/.."
skip() { echo "skip container_lives_and_is_nobody_special: $1"; echo "0 passed, 0 failed, 1 skipped"; exit 0; }
command -v buildah >/dev/null 2>&1 || skip "no buildah here"
[ "$(id -u)" -eq 0 ] || skip "buildah needs root here"
work=$(mktemp -d /tmp/awtd-container-XXXXXX)
b() { buildah --root "$work/root" --runroot "$work/run" --storage-driver vfs "$@"; }
daemon=
finish() {
    [ -n "$daemon" ] && kill "$daemon" 2>/dev/null && wait "$daemon"
    b rm -a >/dev/null 2>&1
    b rmi -a -f >/dev/null 2>&1
    rm -rf "$work"
}
trap finish EXIT
trap "exit 1" INT TERM HUP
fail() { tail -n 20 "$work/log"; echo "FAIL container_lives_and_is_nobody_special: $1"; echo "0 passed, 1 failed, 0 skipped"; exit 1; }

if [ -n "${DEBIAN_BASE:-}" ]; then
    base=$(b from scratch) && b copy -q "$base" "$DEBIAN_BASE" / >"$work/log" 2>&1 &&
        b commit -q --rm "$base" docker.io/library/debian:bookworm-slim >>"$work/log" 2>&1 || fail "no base of $DEBIAN_BASE"
else
    b pull -q docker.io/library/debian:bookworm-slim >"$work/log" 2>&1 ||
        skip "debian:bookworm-slim cannot be fetched, and DEBIAN_BASE names no Debian"
fi
b build --isolation chroot --format docker --pull=never -f docker/Dockerfile -t awtd . >"$work/log" 2>&1 || fail "it does not build"
size=$(b images --json awtd | sed -n 's/.*"size": "\(.*\)".*/\1/p')
box=$(b from --pull=never awtd)
b run --isolation chroot "$box" -- awtd --listen 127.0.0.1:0 --admin 127.0.0.1:0 >"$work/out" 2>"$work/log" &
daemon=$!
address=
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    address=$(sed -n 's/^listening on //p' "$work/out")
    [ -n "$address" ] && break
    sleep 0.5
done
[ -n "$address" ] || fail "it does not come up"
b run --isolation chroot "$box" -- awtctl ping --count 1 --connect "$address" >>"$work/log" 2>&1 || fail "it does not answer"
b run --isolation chroot "$box" -- sh -c '[ "$(id -u)" = 10001 ] && ! touch /usr/bin/x 2>/dev/null && ! touch /etc/x 2>/dev/null' ||
    fail "its user may do too much"
b run --isolation chroot "$box" -- awtctl ping --count 1 --connect 127.0.0.1:1 >/dev/null 2>&1 && fail "its health check cannot fail"
echo "ok   container_lives_and_is_nobody_special ($size)"
echo "1 passed, 0 failed, 0 skipped"
