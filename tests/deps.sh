#!/bin/sh
# deps.sh run|viewer|test|soak: installs the Debian packages that awtd (run), the viewer (viewer), the tests (test) and the
# long tests (soak) need, where a command or header that they bring is missing. DEPS=never installs nothing. Prints first what it will install.
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
    want nodejs has node
    want npm has npm
    want emscripten has emcc
fi
if [ "$1" = test ] || [ "$1" = soak ]; then
    want clang has clang
    want chromium has chromium
    want nlohmann-json3-dev has_header nlohmann/json.hpp
    want libclang-rt-dev has_clang_runtime
    want python3 has python3
    want python3-numpy /usr/bin/python3 -c 'import numpy'
    want python3-setuptools /usr/bin/python3 -c 'import setuptools'
    want python3-pip /usr/bin/python3 -c 'import pip'
    want python3-venv /usr/bin/python3 -c 'import venv, ensurepip'
    want gcc-mingw-w64-x86-64 has x86_64-w64-mingw32-gcc
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

# npm_packages FOLDER PURPOSE: what its package-lock.json names, where that is not there yet.
npm_packages() {
    cmp -s "$1/package-lock.json" "$1/node_modules/.installed" && return
    if [ "${DEPS:-}" = never ]; then
        [ -d "$1/node_modules" ] || echo "$1/node_modules is missing: there is no $2" >&2
    else
        echo "installing npm packages for $2 ($1/package-lock.json)"
        (cd "$1" && npm ci --no-audit --no-fund --loglevel=error && cp package-lock.json node_modules/.installed)
    fi
}
if [ "$1" != run ]; then
    npm_packages clients/web "the viewer"
fi
if [ "$1" = test ] || [ "$1" = soak ]; then
    npm_packages tests/node "the glTF checks"
    npm_packages tests/web "the tests in a browser"
fi
