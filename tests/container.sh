#!/bin/sh
# container.sh: builds docker/Dockerfile with buildah, runs awtd of it as the user that it names, and asks whether it lives, as
# the image's own health check does. Where there is podman, it is also run as docker/README.md says: with a root that is
# read-only, without capabilities. Everything is kept in one folder, and removed. Skips where there is no buildah.
# DEBIAN_BASE: a folder with a Debian 12 (debootstrap --variant=minbase), where no registry can be reached.
set -u
cd "$(dirname "$0")/.."
skip() { echo "skip container_lives_and_is_nobody_special: $1"; echo "0 passed, 0 failed, 1 skipped"; exit 0; }
command -v buildah >/dev/null 2>&1 || skip "no buildah here"
[ "$(id -u)" -eq 0 ] || skip "buildah needs root here"
work=$(mktemp -d /tmp/awtd-container-XXXXXX)
b() { buildah --root "$work/root" --runroot "$work/run" --storage-driver vfs "$@"; }
# The limits are below those of most machines; health checks by the clock would need systemd.
p() { podman --root "$work/root" --runroot "$work/run" --volumepath "$work/volumes" --storage-driver vfs --cgroup-manager cgroupfs "$@"; }
daemon=
finish() {
    [ -n "$daemon" ] && kill "$daemon" 2>/dev/null && wait "$daemon"
    command -v podman >/dev/null 2>&1 && p rm -f -a >/dev/null 2>&1
    b rm -a >/dev/null 2>&1
    b rmi -a -f >/dev/null 2>&1
    rm -rf "$work"
}
trap finish EXIT
trap "exit 1" INT TERM HUP
test=container_lives_and_is_nobody_special passed=0
fail() { tail -n 20 "$work/log"; echo "FAIL $test: $1"; echo "$passed passed, 1 failed, 0 skipped"; exit 1; }

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
echo "ok   $test ($size)"

test=container_runs_with_a_read_only_root_and_no_capabilities passed=1
if ! command -v podman >/dev/null 2>&1; then
    echo "skip $test: no podman here"
    echo "1 passed, 0 failed, 1 skipped"
    exit 0
fi
p run -d --name awtd --read-only --cap-drop ALL --security-opt no-new-privileges --ulimit nofile=4096:4096 \
    --ulimit nproc=4096:4096 --health-interval=disable --network host -v awtd-state:/var/lib/awtd awtd \
    --listen 127.0.0.1:0 --admin 127.0.0.1:0 >"$work/log" 2>&1 || fail "it does not start"
address=
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    address=$(p logs awtd 2>&1 | sed -n 's/^listening on //p')
    [ -n "$address" ] && break
    sleep 0.5
done
[ -n "$address" ] || fail "it does not come up"
p exec awtd awtctl ping --count 1 --connect "$address" >>"$work/log" 2>&1 || fail "it does not answer"
p exec awtd sh -c '[ "$(id -u)" = 10001 ] && ! touch /x /tmp/x 2>/dev/null && grep -q "^CapEff:.*0000000000000000$" /proc/1/status' ||
    fail "it may do too much"
p exec awtd cat /var/lib/awtd/token | grep -q "^[0-9a-f]\{32\}$" || fail "there is no token in its volume"
p stop -t 10 awtd >>"$work/log" 2>&1
status=$(p inspect --format '{{.State.ExitCode}}' awtd)
[ "$status" = 0 ] || fail "it ends with $status"
echo "ok   $test"
echo "2 passed, 0 failed, 0 skipped"
