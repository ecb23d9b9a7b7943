#!/bin/sh
# sheets.sh BUILD: a contact sheet of every built-in style, and of every real groom that is there, played through the lean:
# at rest, in the first bow, on the way up, at rest again; from the front and from behind. What we may give away (our own
# styles; hair under licences that allow it, named in README.md) goes to tests/render/sheets, the rest to build/sheets.
#
# AWT_DATA: where real grooms are (else ../shared/data).
set -eu
cd "$(dirname "$0")/../.."
build=$1
hair=${AWT_DATA:-../shared/data}/hair
mkdir -p tests/render/sheets build/sheets
if [ ! -d tests/node/node_modules/draco3d ] || ! command -v node >/dev/null 2>&1; then
    echo "sheets: node or its packages are not here: sh tests/deps.sh test" >&2
    exit 1
fi

work=$(mktemp -d "${TMPDIR:-/tmp}/awtd-sheets.XXXXXX")
daemon=
# shellcheck disable=SC2064,SC2154
trap 'status=$?; [ -z "$daemon" ] || kill $daemon 2>/dev/null || true; rm -rf "$work"; exit $status' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP

. tests/start_awtd.sh
[ -n "$address" ] || { cat "$work/log" >&2; exit 1; }

# sheet PICTURE PLAY-OPTIONS...: times are frames of 60 a second.
sheet() {
    picture=$1
    shift
    echo "== $picture"
    "$build/awtctl" play --connect "$address" --token-file "$work/state/token" "$@" --motion lean --fps 60 --every 15 \
        --out "$work/frames" --json "$work/frames/play.json" --quiet >"$work/play.log" || { cat "$work/play.log" >&2; exit 1; }
    node tests/render/render.mjs --out "$picture" --colliders "$work/frames/play.json" --size 280x300 --colours 160 \
        --views three-quarter,back-quarter --labels "at rest,bowed 1.75 s,rising 2.5 s,at rest again" \
        "$work/frames/frame_000060.glb" "$work/frames/frame_000105.glb" "$work/frames/frame_000150.glb" \
        "$work/frames/frame_000600.glb" | tail -n 1
    rm -rf "$work/frames"
}

for style in short short-curly long long-curly; do
    sheet tests/render/sheets/$style.png --style $style
done
for groom in tests/render/sheets:sintel_16pt.v4.tfx tests/render/sheets:ratboy_mohawk.v4.tfx build/sheets:yuksel_straight.hair; do
    file=${groom#*:}
    if [ -f "$hair/$file" ]; then
        sheet "${groom%%:*}/${file%%.*}.png" --groom "$hair/$file"
    else
        echo "skip: there is no $hair/$file"
    fi
done
