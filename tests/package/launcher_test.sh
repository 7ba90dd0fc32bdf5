#!/usr/bin/env bash
# launcher_test.sh LAUNCHER: the launcher becomes the program of the best instruction set that this processor has and
# that is installed, or of the one that PBRT_INSTRUCTION_SET names.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAIL: $*" >&2
  exit 1
}
mkdir -p "$work/moved folder/bin"
cd "$work/moved folder"
cp "$1" bin/pbrt
add() { # add SET: a program that says which it is
  mkdir -p "lib/pbrt_octree/$1/bin"
  printf '#!/bin/sh\necho "%s" "$@"\nexit 3\n' "$1" > "lib/pbrt_octree/$1/bin/pbrt"
  chmod +x "lib/pbrt_octree/$1/bin/pbrt"
}
started() { # started WHAT: what the launcher became, which ends with status 3
  local status=0 text
  text=$("$work/moved folder/bin/pbrt" "a b" c) || status=$?
  [ "$text" = "$1 a b c" ] || fail "expected $1, got: $text"
  [ "$status" = 3 ] || fail "the program's status 3 became $status"
}
has() { local flag; for flag in "$@"; do grep -m1 '^flags' /proc/cpuinfo | grep -qw "$flag" || return 1; done; }

if bin/pbrt 2> error.txt; then fail "it started something although nothing is installed"; fi
grep -q "no program pbrt was installed" error.txt || fail "$(cat error.txt)"
add x86-64
started x86-64
best=x86-64
add x86-64-v3
if has avx2 bmi1 bmi2 f16c fma movbe; then best=x86-64-v3; fi
started "$best"
add x86-64-v4
if has avx2 bmi2 fma avx512f avx512bw avx512cd avx512dq avx512vl; then best=x86-64-v4; fi
started "$best"
PBRT_INSTRUCTION_SET=x86-64 started x86-64
PBRT_INSTRUCTION_SET= started "$best"
if PBRT_INSTRUCTION_SET=x86-64-v9 bin/pbrt 2> error.txt; then fail "a set that does not exist was taken"; fi
grep -q '"x86-64-v9".* valid .*x86-64\.' error.txt || fail "$(cat error.txt)"
echo "ok: launcher, $best"
