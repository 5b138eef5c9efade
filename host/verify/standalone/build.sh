#!/bin/sh
# Builds ./claray-verify. Variables: CXX, CXXFLAGS (such as -I), LDFLAGS, JOBS (compilers at once).
set -e
cd "$(dirname "$0")"
: "${CXX:=g++}" "${JOBS:=$(nproc 2>/dev/null || echo 2)}"
flags="-std=c++20 -O1 -w -ffp-contract=off -I. -Iinclude $CXXFLAGS"  # the oracles round as they are written
rm -rf objects
mkdir objects
$CXX $flags -x c++-header precompiled.hpp -o precompiled.hpp.gch
ls -S units | sed 's/\.cpp$//' | xargs -P "$JOBS" -I{} $CXX $flags -include precompiled.hpp -c units/{}.cpp -o objects/{}.o
$CXX objects/*.o $LDFLAGS -lOpenCL -lpthread -ldl -o claray-verify
