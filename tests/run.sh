#!/usr/bin/env bash
# Runs all tests: installs what is missing, checks include directions, builds without extensions and tests what that
# changes, builds everything and tests that, runs programs with sanitizers. Last line: "N passed, M failed".
set -uo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
cd "$top"
passed=0
failed=0
failures=()
count() { # count NAME STATUS: one result
  if [ "$2" -eq 0 ]; then passed=$((passed + 1)); echo "ok    $1"; else failed=$((failed + 1)); failures+=("$1"); echo "FAIL  $1"; fi
}
stage() { echo "[$((SECONDS / 60)) min] $*"; }
run_ctest() { # run_ctest NAME FOLDER [ctest options]: adds ctest's own counts
  local name=$1 folder=$2 log line
  shift 2
  log="$folder/ctest-$name.log"
  # Three at a time on two cores, as some mostly wait.
  ctest --test-dir "$folder" -j 3 --output-on-failure "$@" > "$log" 2>&1
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

# Names (as those of ctest's tests begin) of the unit programs that do not depend on which light samplers are built.
extension_free_units() {
  local program
  for program in $(ninja -C "$1" -t targets all | sed -n 's|^tests/unit/.*/unit_\([a-z_]*\): CXX_EXECUTABLE.*|\1|p'); do
    [[ $(ninja -C "$1" -t inputs "unit_$program") == *pbrt_plugins* ]] || echo "$program"
  done
}

bash .ci/install || exit 1
python3 .ci/check_layers.py
count "include directions" $?
bash .ci/check_format
count "format (.clang-format)" $?

# Long tests of what no extension changes run once, with extensions: pages in a browser, scripts, documents, scenes of the
# contract, most integrators, programs that are killed, divided or adapt. Each kind has shorter ones that run twice.
once="^(program|docs|develop)\\.|^contract\\.scenes\\."
once+="|^integrators\\.(together|Mlt|Sppm|Bdpt|VolPath|AdaptiveRender|MediaInPlaces|.*/)"
once+="|^pbrt_program\\.Checkpoints\\.(PhotonMaps|Timed|Interrupted)"
once+="|^pbrt_program\\.Mpi\\.(AKilled|ASignal|Time|Errors|Without)"
once+="|^pbrt_program\\.(Adaptive\\.(Killed|AnyNumber|TheNoise|Less)|Budget\\.Every)"

# One build folder serves both: switching PBRT_EXT recompiles only what depends on it. Programs that do not run without
# extensions are built with them only (`.ci/run stock` builds all of them without).
stage "Building without extensions (build/release.log)"
core_programs=(unit_tests contract_scene_samplers)
if bash .ci/build "$top/build/release" -DPBRT_EXT=OFF -DPBRT_WERROR=ON -DPBRT_UNITY=ON -- "${core_programs[@]}"; then
  # Programs that no extension can change run below.
  same=$(extension_free_units build/release | paste -sd "|")
  stage "Testing without extensions"
  run_ctest core build/release -L "unit|contract" -E "$once|^(${same:-none})\\."
else
  count "build without extensions" 1
fi
stage "Building everything (build/release.log)"
if bash .ci/build "$top/build/release" -DPBRT_EXT=ON -DPBRT_WERROR=ON -DPBRT_UNITY=ON; then
  stage "Testing everything"
  run_ctest all build/release
  for table in build/release/tables/*.txt; do
    [ -f "$table" ] && { echo; cat "$table"; }
  done
  build/release/src/pbrt/cmd/pbrt/pbrt --list lightsamplertables | diff - docs/reference/lightsamplers.md > /dev/null
  count "docs/reference/lightsamplers.md is the output of pbrt --list lightsamplertables" $?
  build/release/src/pbrt/cmd/pbrt/pbrt --list all | diff - docs/reference/parameters.md > /dev/null
  count "docs/reference/parameters.md is the output of pbrt --list all" $?
else
  count "build" 1
fi

# Sanitizers. Programs of several cases run in one process each, as loading libraries costs more than most cases.
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
# Up to GCC 13 the leak check takes some blocks of thread-local memory for those of glibc 2.19 and crashes
# (github.com/google/sanitizers/issues/1322).
export ASAN_OPTIONS=intercept_tls_get_addr=0
export TSAN_OPTIONS=halt_on_error=1:suppressions=$top/tests/support/thread_sanitizer.txt
logged() { # logged LOG COMMAND...: the last line of the log is "status N"
  local log=$1
  shift
  { "$@"; echo "status $?"; } > "$log" 2>&1
}
export -f logged
run_sanitized() { # run_sanitized KIND: runs the "NAME COMMAND" lines of standard input, two at a time
  local kind=$1 name status
  local -a names=()
  while read -r name command; do
    names+=("$name")
    printf '%s\0' "logged build/$kind/$name.log $command"
  done > "build/$kind/commands"
  xargs -0 -P 2 -I {} bash -c '{}' < "build/$kind/commands"
  for name in "${names[@]}"; do
    [ "$(tail -1 "build/$kind/$name.log")" = "status 0" ]
    status=$?
    count "$name ($kind)" $status
    [ $status -eq 0 ] || tail -60 "build/$kind/$name.log"
  done
}

# Addresses and undefined behaviour: the programs with every integrator and light sampler, every kind of file that they write
# and read again, and all conformance scenes. `.ci/run asan` has all unit and contract tests.
stage "Building with address and undefined-behaviour sanitizers (build/asan.log)"
if bash .ci/build "$top/build/asan" -DPBRT_SANITIZE=address,undefined "-DCMAKE_CXX_FLAGS_SANITIZED=-O0 -DNDEBUG" \
    -DPBRT_BENCH=OFF -DPBRT_UNITY=ON -- pbrt imgtool lightlab; then
  stage "Running with address and undefined-behaviour sanitizers"
  run_sanitized asan <<COMMANDS
programs bash tests/stress/programs_once.sh build/asan
conformance_scenes bash tests/stress/scenes_once.sh build/asan
COMMANDS
else
  count "build with address and undefined-behaviour sanitizers" 1
fi

# Threads: rendering while the light sampler learns. Only what works on several threads is compiled for it.
stage "Building with the thread sanitizer (build/release.log)"
mkdir -p build/tsan
if bash .ci/build "$top/build/release" -- render_learning_threads; then
  run_sanitized tsan <<COMMANDS
render_learning build/release/tests/render/render_learning_threads --gtest_filter=*Threads*
COMMANDS
else
  count "build with the thread sanitizer" 1
fi
stage "Done"
echo
for f in "${failures[@]+"${failures[@]}"}"; do echo "failed: $f"; done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
