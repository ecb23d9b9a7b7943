#!/bin/sh
# suite.sh CONFIG-DIRECTORY: installs clients/python into a virtual environment, without a network, and runs its tests.
set -eu
build=$1
python=/usr/bin/python3
[ -x "$python" ] || python=python3
if ! "$python" -c 'import setuptools, pip, numpy, ensurepip, venv' 2> /dev/null; then
    echo "skip  python: NumPy, setuptools, pip or venv is not here"
    echo "0 passed, 0 failed, 1 skipped"
    exit
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if ! { ${MAKE:-make} -s libraries config="$(basename "$build")" && "$python" -m venv --without-pip --system-site-packages "$work/venv" &&
    cp -r clients/python "$work/package" &&
    "$work/venv/bin/python" -m pip install -q --no-index --no-build-isolation --no-deps "$work/package"; } > "$work/log" 2>&1; then
    cat "$work/log"
    echo "0 passed, 1 failed, 0 skipped"
    exit 1
fi
AWTD_LIBRARY=$(ls "$PWD/$build"/lib/libawtclient.so.*)
export AWTD_LIBRARY
"$work/venv/bin/python" -B tests/python/run.py "$build"
