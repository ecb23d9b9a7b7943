#!/bin/sh
# suite.sh BUILD: gltf-validator and draco3d judge frames of the encoder, against the positions that went in, and what the command
# line client leaves behind after playing each style; three.js, gltf-transform and tinygltf load them and must agree; the receiver as WebAssembly makes strands of guides, and is built for Windows.
set -u
cd "$(dirname "$0")/../.."
build=$1
passed=0 failed=0 skipped=0
if [ ! -d tests/node/node_modules/gltf-validator ] || ! command -v node >/dev/null 2>&1; then
    echo "skip: node or its packages are not here"
    echo "0 passed, 0 failed, 15 skipped"
    exit 0
fi
work=$(mktemp -d)
daemon=
trap '[ -z "$daemon" ] || { kill $daemon; wait $daemon; } 2>/dev/null; rm -rf "$work"' EXIT

# judge NAME COMMAND...: the command writes GLB files into $work/NAME, which $checker then reads.
checker=tests/node/check_glb.mjs
judge() {
    name=$1
    shift
    if "$@" >"$work/$name.log" 2>&1 && node "$checker" "$work/$name"/*.glb >>"$work/$name.log" 2>&1; then
        passed=$((passed + 1))
        echo "ok   $name: $(ls "$work/$name" | grep -c 'glb$') files"
    else
        failed=$((failed + 1))
        cat "$work/$name.log"
        echo "FAIL $name"
    fi
}

# cross NAME COMPILER COMMAND...: the command, where its compiler is here; its output is shown.
cross() {
    name=$1
    compiler=$2
    shift 2
    if ! command -v "$compiler" >/dev/null 2>&1; then
        skipped=$((skipped + 1))
        echo "skip $name: $compiler is not here"
    elif "$@" >"$work/cross.log" 2>&1; then
        passed=$((passed + 1))
        echo "ok   $name: $(tail -n 1 "$work/cross.log")"
    else
        failed=$((failed + 1))
        cat "$work/cross.log"
        echo "FAIL $name"
    fi
}
# others NAME: the same files before the loaders that people use.
others() {
    cross "$1 as others load them" true load "$work/$1"/*.glb
}
load() {
    "$build/read_tinygltf" "$@" && transform "$@" && node tests/node/check_others.mjs "$@"
}
# What the command line of gltf-transform says of a file, and makes of it when it decodes it, into FILE.cli. It takes its time to
# start, so that a few files have to stand for all.
transform() {
    for file in "$@"; do
        case ${file##*/} in
        *-1x2.glb | *-1x100.glb | *-40x3.glb | *-600x24.glb | *-50000x16.glb | patch0-0.glb | attributes-0.glb | attributes-2.glb | nodes-long.glb) echo "$file" ;;
        esac
    done | xargs -P "$(getconf _NPROCESSORS_ONLN)" -I FILE sh -c 'mkdir "$1.cli" && "$2" inspect --format csv "$1" >"$1.cli/inspect.csv" &&
        "$2" copy "$1" "$1.cli/hair.glb"' transform FILE tests/node/node_modules/.bin/gltf-transform
}
as_webassembly() {
    make --no-print-directory "$build/receiver.wasm" B="$build" && node tests/node/check_receiver.mjs "$build/receiver.wasm" "$work/guides"
}

if ! make --no-print-directory "$build/read_tinygltf" B="$build" >"$work/cross.log" 2>&1; then
    failed=$((failed + 1))
    cat "$work/cross.log"
    echo "FAIL tinygltf with Draco does not build"
fi

mkdir "$work/nodes"
checker=tests/node/check_nodes.mjs
judge nodes env AWT_FRAMES="$work/nodes" "$build/tests" geom_nodes_for_other_readers
others nodes
checker=tests/node/check_glb.mjs

mkdir "$work/guides"
judge guides env AWT_FRAMES="$work/guides" "$build/tests" geom_guides_for_other_receivers
others guides
cross "receiver for Windows" x86_64-w64-mingw32-gcc make --no-print-directory "$build/receiver.dll" B="$build"
cross "receiver as WebAssembly" emcc as_webassembly
cross "client library for Windows" x86_64-w64-mingw32-gcc make --no-print-directory "$build/client.dll" B="$build"
cross "client library as WebAssembly" emcc make --no-print-directory "$build/client.wasm" B="$build"

mkdir "$work/frames"
judge frames env AWT_FRAMES="$work/frames" "$build/tests" geom_frames_for_other_readers
others frames

mkdir "$work/attributes"
judge attributes env AWT_FRAMES="$work/attributes" "$build/tests" geom_attributes_for_other_readers
others attributes

. tests/start_awtd.sh
for style in short short-curly long long-curly; do
    judge $style "$build/awtctl" play --connect "$address" --token-file "$work/state/token" --style $style --strands 2000 \
        --motion lean --frames 120 --every 40 --out "$work/$style" --quiet --json "$work/$style.json"
done
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed -eq 0 ]
