#!/bin/sh
# run.sh: every test: unit tests and daemon with client end to end, with gcc and then with clang under ASan and UBSan; inputs
# of a committed corpus and what libFuzzer makes of them in a bounded number of runs; what
# the command line client writes before other people's glTF tools; and a client in another language. Its last line counts all.
set -u
cd "$(dirname "$0")/.."
. tests/suites.sh

build config=release
shared_beside "every test, clang, ASan and UBSan" build/asan/tests config=asan CC=clang CXX=clang++
shared "every test, gcc -O2" build/release/tests
suite "awtctl's files before other glTF tools" sh tests/node/suite.sh build/release
suite "what make install puts down" sh tests/install/suite.sh build/release
suite "a client written from PROTOCOL.md alone" python3 -B tests/stranger/test_stranger.py build/release
suite "the Python client" sh tests/python/suite.sh build/release
suite "gateway and viewer, in a browser" sh tests/web/suite.sh build/release
shared_joined
suite "what reads bytes from outside, fuzzed from the corpus" sh tests/fuzz/suite.sh build/asan
finish
