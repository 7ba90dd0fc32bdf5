#!/usr/bin/env bash
# package_test.sh install|deb BUILD: installs the build into a folder, or makes its Debian package and unpacks it there,
# moves the folder, and uses the programs.
set -euo pipefail
kind=$1
build=$(realpath "$2")
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAIL: $*" >&2
  exit 1
}

if [ "$kind" = install ]; then
  cmake --install "$build" --prefix "$work/first" > "$work/install.log"
  mv "$work/first" "$work/moved folder"
  root="$work/moved folder"
else
  (cd "$work" && cpack --config "$build/CPackConfig.cmake" -B "$work/pack" > "$work/cpack.log" 2>&1) ||
    { cat "$work/cpack.log"; fail "cpack"; }
  package=$(ls "$work"/pack/*.deb)
  dpkg-deb --field "$package" Package Version Depends Recommends
  for library in libembree3 libopenimageio2 libtbb libopenexr libfmt; do
    dpkg-deb --field "$package" Depends | grep -q "$library" || fail "the package does not depend on $library"
  done
  mkdir "$work/root"
  dpkg-deb --extract "$package" "$work/root"
  root="$work/root/usr"
fi

# Nothing leads back to where it was built.
for place in "$build" "$top"; do
  found=$(grep -rlaF "$place" "$root" || true)
  [ -z "$found" ] || fail "$place is named in: $found"
done

run() { env -i HOME="$work" PATH="$root/bin:/usr/bin:/bin" MPLCONFIGDIR="$work" "$@"; }
cd "$work"
scene="$top/scenes/three-lights/three-lights.pbrt"
run pbrt --version | grep -q pbrt_octree || fail "pbrt --version"
run pbrt --quiet --quick --spp 2 --lightsampler power --outfile picture.exr "$scene"
# JPEG is written by the module that calls OpenImageIO.
run imgtool convert picture.exr picture.jpg > /dev/null 2>&1
file picture.jpg | grep -q JPEG || fail "no JPEG"
mv "$root/lib/pbrt_octree" "$root/lib/elsewhere"
if run imgtool convert picture.exr other.jpg > /dev/null 2>&1; then fail "a JPEG without the installed module"; fi
mv "$root/lib/elsewhere" "$root/lib/pbrt_octree"
run lightlab "$scene" --spp 1 --seeds 2 --reference-spp 2 --divisor 8 --samplers power,bvh --selection-work 0 --quiet \
  --cache "$work/cache" --out "$work/lab" > lab.txt
[ -s "$work/lab/report.html" ] || fail "lightlab wrote no report.html"

for program in pbrt lightlab imgtool; do
  page="$root/share/man/man1/$program.1"
  [ -f "$page" ] || { gunzip -k "$page.gz" && [ -f "$page" ]; } || fail "no manual page of $program"
  grep -qi "^\.TH $program " "$page" || fail "the title of $program's page"
  for flag in $(run "$program" --help | grep -oE -- '^ +--[a-z][a-z-]+' | tr -d ' '); do
    grep -qF -- "${flag//-/\\-}" "$page" || fail "$flag is not in $program's page"
  done
  complete="$root/share/bash-completion/completions/$program"
  [ -f "$complete" ] || fail "no completion for $program"
done
completed() { # completed WORDS...: what the last of them may become
  run bash -c 'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); previous=${COMP_WORDS[COMP_CWORD - 1]}
    _pbrt_octree "$1" "${COMP_WORDS[COMP_CWORD]}" "$previous"; printf "%s\n" "${COMPREPLY[@]}"' \
    "$root/share/bash-completion/completions/pbrt" "$@"
}
completed pbrt --outf | grep -qx -- --outfile || fail "completion of --outf"
completed pbrt --lightsampler oct | grep -qx octree || fail "completion of a light sampler"
completed pbrt --aov alb | grep -qx albedo || fail "completion of a channel"
completed imgtool conv | grep -qx convert || fail "completion of imgtool's commands"
completed imgtool diff --met | grep -qx -- --metric || fail "completion of a command's flags"
[ "$(completed pbrt --no-such-flag)" = "" ] || fail "a flag that does not exist is completed"
echo "ok: $kind"
