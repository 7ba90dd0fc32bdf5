#!/usr/bin/env bash
# Runs all tests: installs what is missing, checks include directions, builds without extensions and tests that, builds
# everything and tests that. Last line: "N passed, M failed".
set -uo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
cd "$top"
passed=0
failed=0
failures=()
count() { # count NAME STATUS: one result
  if [ "$2" -eq 0 ]; then passed=$((passed + 1)); echo "ok    $1"; else failed=$((failed + 1)); failures+=("$1"); echo "FAIL  $1"; fi
}
run_ctest() { # run_ctest NAME FOLDER [ctest options]: adds ctest's own counts
  local name=$1 folder=$2 log line
  shift 2
  log="$folder/ctest-$name.log"
  ctest --test-dir "$folder" -j 2 --output-on-failure "$@" > "$log" 2>&1
  local bad=$?
  # Tables of the conformance and agreement tests are worth seeing.
  line=$(grep -E "tests passed, [0-9]+ tests? failed out of [0-9]+" "$log" | tail -1)
  if [ -z "$line" ]; then
    tail -20 "$log"
    count "$name: ctest" 1
    return
  fi
  local total failing
  total=$(sed -E 's/.* out of ([0-9]+).*/\1/' <<< "$line")
  failing=$(sed -E 's/.*passed, ([0-9]+) tests? failed.*/\1/' <<< "$line")
  passed=$((passed + total - failing))
  failed=$((failed + failing))
  echo "$name: $line"
  if [ "$bad" -ne 0 ]; then
    failures+=("$name: see $log")
    grep -vE "^ *[0-9]+/[0-9]+ Test .* Passed|^ +Start +[0-9]+:" "$log" | tail -150
  fi
  grep -E "SKIPPED|\(Skipped\)" "$log" | sort -u | head -10
}

bash .ci/install || exit 1
python3 .ci/check_layers.py
count "include directions" $?

# One build folder serves both: switching PBRT_EXT recompiles only what depends on it.
echo "Building without extensions (build/release.log)"
if bash .ci/build "$top/build/release" -DPBRT_EXT=OFF -DPBRT_WERROR=ON; then
  run_ctest core build/release -L "unit|contract"
else
  count "build without extensions" 1
fi
echo "Building everything (build/release.log)"
if bash .ci/build "$top/build/release" -DPBRT_EXT=ON -DPBRT_WERROR=ON; then
  run_ctest all build/release
  for table in build/release/tables/*.txt; do
    [ -f "$table" ] && { echo; cat "$table"; }
  done
  build/release/src/pbrt/cmd/pbrt/pbrt --list-lightsamplers | diff - docs/lightsamplers.md > /dev/null
  count "docs/lightsamplers.md is the output of pbrt --list-lightsamplers" $?
else
  count "build" 1
fi
echo
for f in "${failures[@]+"${failures[@]}"}"; do echo "failed: $f"; done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
