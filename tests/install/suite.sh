#!/bin/sh
# suite.sh CONFIG-DIRECTORY: installs into a folder of its own and builds and runs small programs against what is there,
# in C and C++, with the shared and with the static library. Looks, too, that the libraries show no name but theirs.
set -eu
build=$1
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "install: $1" >&2; exit 1; }

${MAKE:-make} -s install config="$(basename "$build")" prefix="$place" > "$place/log" 2>&1 || { cat "$place/log" >&2; exit 1; }
"$place/bin/awtd" --version > /dev/null || fail 'awtd does not run'

seen() { nm -g --defined-only "$@" | awk 'NF == 3 && $2 != "A" { sub(/@.*/, "", $3); print $3 }'; }
for kind in a so; do
    flag=$([ $kind = so ] && echo -D || echo -g)
    others=$(seen "$flag" "$place/lib/libawtclient.$kind" | grep -vE '^(awt(client|hair|session|link|frames|clock|lead|pace|space|write)|proto)_' || true)
    [ -z "$others" ] || fail "libawtclient.$kind shows $others"
done

# What pkg-config would say, where there is none.
flags() {
    if command -v pkg-config > /dev/null; then
        PKG_CONFIG_PATH="$place/lib/pkgconfig" pkg-config --cflags --libs "$1"
    else
        sed -n 's/^\(Cflags\|Libs\): //p' "$place/lib/pkgconfig/$1.pc" | tr '\n' ' '
    fi
}
for header in "$place"/include/awt/*.h; do # each stands alone, in both languages
    for compiler in "${CC:-cc} -x c -std=c17" "${CXX:-c++} -x c++ -std=c++11" "${CXX:-c++} -x c++ -std=c++20"; do
        echo "#include <$(basename "$header")>" | $compiler -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I"$place/include/awt" - ||
            fail "$(basename "$header") alone, by $compiler"
    done
done
for language in c c++; do
    compiler=$([ $language = c ] && echo "${CC:-cc} -std=c17" || echo "${CXX:-c++} -std=c++17")
    $compiler -x $language -Wall -Wextra -Werror -o "$place/shared" tests/install/engine.c $(flags awtclient)
    LD_LIBRARY_PATH="$place/lib" "$place/shared" > /dev/null || fail "the $language program with the shared library"
    $compiler -x $language -Wall -Wextra -Werror -I"$place/include/awt" -o "$place/static" tests/install/engine.c \
        -x none "$place/lib/libawtclient.a" -lm
    "$place/static" > /dev/null || fail "the $language program with the static library"
done
${CC:-cc} -std=c17 -o "$place/simulation" tests/install/simulation.c $(flags awt)
LD_LIBRARY_PATH="$place/lib" "$place/simulation" > /dev/null || fail 'the program with libawt'
echo 'ok   programs, libraries and headers work where they were put, in C and C++'

# The README's example in C, as it stands there, before a daemon.
awk '/^    #include <awtclient.h>/ { on = 1 } on && !/^    / { exit } on { print substr($0, 5) }' README.md > "$place/hair.c"
work=$place build=$place/bin
. tests/start_awtd.sh
trap 'kill "$daemon"; wait "$daemon" || true; rm -rf "$place"' EXIT
[ -n "$address" ] || fail 'awtd does not listen'
${CC:-cc} -std=c17 -Wall -Wextra -Werror -o "$place/hair" "$place/hair.c" $(flags awtclient) -lm
LD_LIBRARY_PATH="$place/lib" "$place/hair" "$address" "$place/state/token" > "$place/said" || fail 'the example of the README'
[ "$(grep -c '^2000 strands; the first ends at x = -\{0,1\}[0-9.]* m$' "$place/said")" -eq 60 ] || fail "the example of the README said $(tail -n 2 "$place/said")"
[ "$(sort -u "$place/said" | wc -l)" -gt 10 ] || fail 'the hair of the example does not move'
echo 'ok   the example of the README in C'
echo '2 passed, 0 failed, 0 skipped'
