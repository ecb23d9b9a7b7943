#!/bin/sh
# demo.sh: called by `make demo`: starts a daemon of its own on a free port, plays a clip through it, stops it whatever
# happens, and says where the files are. GROOM MOTION JOINT SCALE UP HEAD (all may be empty): your own hair and motion.
set -eu

out=build/demo
state=$(mktemp -d "${TMPDIR:-/tmp}/awtd-demo.XXXXXX")
log=$state/log
. clients/beside.sh

fail() {
    echo "demo: $1" >&2
    sed 's/^/  awtd: /' "$log" >&2 || true
    exit 1
}

for program in build/awtd build/awtctl; do
    [ -x "$program" ] || { echo "demo: $program is missing: make" >&2; exit 1; }
done

build/awtd --listen 127.0.0.1:0 --state-dir "$state" >"$log" 2>&1 &
daemon=$!
processes=$daemon
address=$(said "$log" "listening on " "$daemon") || fail "awtd did not start, or does not say that it listens:"

# Options for what was given, in "$@".
set -- --connect "$address" --token-file "$state/token" --fps 60 --out "$out" --json "$out/play.json"
if [ -n "${GROOM:-}" ]; then set -- "$@" --groom "$GROOM"; else set -- "$@" --style long; fi
set -- "$@" --motion "${MOTION:-lean}"
if [ -n "${JOINT:-}" ]; then set -- "$@" --joint "$JOINT"; fi
if [ -n "${SCALE:-}" ]; then set -- "$@" --scale "$SCALE"; fi
if [ -n "${UP:-}" ]; then set -- "$@" --up "$UP"; fi
if [ -n "${HEAD:-}" ]; then set -- "$@" "--head=$HEAD"; fi

mkdir -p "$out"
rm -f "$out"/frame_*.glb

# Not in the foreground: a shell runs its traps only between commands, and waiting can be interrupted.
build/awtctl play "$@" &
client=$!
processes="$client $daemon"
wait "$client"
processes=$daemon

echo
echo "GLB files (Draco-compressed glTF, one every so many frames) are in $out, all figures in $out/play.json."
echo "Look at them with anything that reads glTF 2.0 with KHR_draco_mesh_compression: Blender (File, Import, glTF),"
echo "a three.js or Babylon.js viewer in the browser. build/awtctl inspect $out/FILE.glb says what is in one."
