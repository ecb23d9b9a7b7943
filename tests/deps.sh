#!/bin/sh
# deps.sh run|test|soak: installs the Debian packages that awtd (run), its tests (test) and its long tests (soak) need,
# where a command or header that they bring is missing. DEPS=never installs nothing. Prints first what it will install.
set -eu
cd "$(dirname "$0")/.."
wanted=""

# want PACKAGE TEST...: the package, unless the test succeeds.
want() {
    package=$1
    shift
    "$@" >/dev/null 2>&1 || wanted="$wanted $package"
}
has() { command -v "$1"; }
has_header() { printf '#include <%s>\n' "$1" | ${CXX:-c++} -E -x c++ - ; }
has_clang_runtime() { printf 'int main(void){return 0;}\n' | clang -fsanitize=address,undefined -x c -o /dev/null - ; }

want gcc has cc
want make has make
want g++ has c++
if command -v c++ >/dev/null 2>&1; then
    want libdraco-dev has_header draco/draco_features.h
    want libtinygltf-dev has_header tiny_gltf.h
else
    wanted="$wanted libdraco-dev libtinygltf-dev"
fi
if [ "$1" != run ]; then
    want clang has clang
    want nlohmann-json3-dev has_header nlohmann/json.hpp
    want libclang-rt-dev has_clang_runtime
    want nodejs has node
    want npm has npm
    want python3 has python3
    want gcc-mingw-w64-x86-64 has x86_64-w64-mingw32-gcc
    want emscripten has emcc
fi
if [ "$1" = soak ]; then
    want gcc-aarch64-linux-gnu has aarch64-linux-gnu-gcc
    want libc6-dev-arm64-cross test -e /usr/aarch64-linux-gnu/include/stdio.h
    want qemu-user has qemu-aarch64
fi

if [ -n "$wanted" ]; then
    if [ "${DEPS:-}" = never ]; then
        echo "missing, and DEPS=never says not to install:$wanted" >&2
        exit 1
    fi
    if ! command -v apt-get >/dev/null 2>&1; then
        echo "This system has no apt-get. Install what Debian calls:$wanted" >&2
        echo "(Draco and tinygltf with their headers, a C and a C++ compiler) and run again with DEPS=never." >&2
        exit 1
    fi
    root=""
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null 2>&1 || {
            echo "As root, or with sudo: apt-get install$wanted" >&2
            exit 1
        }
        root=sudo
    fi
    echo "installing Debian packages:$wanted"
    $root apt-get update -q
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive $root apt-get install -q -y --no-install-recommends $wanted
fi

if [ "$1" != run ] && ! cmp -s tests/node/package-lock.json tests/node/node_modules/.installed; then
    if [ "${DEPS:-}" = never ]; then
        [ -d tests/node/node_modules ] || echo "tests/node/node_modules is missing: the glTF checks will be skipped" >&2
    else
        echo "installing npm packages for the glTF checks (tests/node/package-lock.json)"
        (cd tests/node && npm ci --no-audit --no-fund --loglevel=error && cp package-lock.json node_modules/.installed)
    fi
fi
