#!/usr/bin/env bash
# clean_root.sh PACKAGE.deb: makes a fresh Debian 12 in a temporary folder, installs the package there with its
# dependencies from Debian's archive, and renders one of our scenes in it. Needs root and debootstrap.
#   cmake -S . -B build/portable -G Ninja -DPBRT_NATIVE=OFF -DPBRT_TESTS=OFF -DPBRT_BENCH=OFF
#   cmake --build build/portable && (cd build/portable && cpack) && tests/package/clean_root.sh build/portable/*.deb
set -euo pipefail
package=$(realpath "$1")
top=$(cd "$(dirname "$0")/../.." && pwd)
root=$(mktemp -d)
trap 'umount "$root/proc" 2> /dev/null || true; rm -rf --one-file-system "$root" "$root.log"' EXIT
# The archive that this machine uses, among whatever else it installs from.
mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources} 2> /dev/null | grep -v '^#' |
  grep -oE 'https?://[^ ]+/debian/?( |$)' | head -1 | tr -d ' ' || true)
debootstrap --variant=minbase bookworm "$root" "${mirror:-http://deb.debian.org/debian}" > "$root.log" || { tail -20 "$root.log"; exit 1; }
cp /etc/apt/apt.conf.d/* "$root/etc/apt/apt.conf.d/" 2> /dev/null || true
cp /etc/resolv.conf /etc/hosts "$root/etc/"
cp "$package" "$root/package.deb"
cp -r "$top/scenes/three-lights" "$root/scene"
# Programs find their modules relative to themselves, which the loader of Linux needs /proc for.
mount -t proc proc "$root/proc"
chroot "$root" bash -ec '
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends /package.deb > /dev/null
  pbrt --version
  pbrt --quick --spp 4 --lightsampler octree --outfile /picture.exr /scene/three-lights.pbrt
  imgtool convert /picture.exr /picture.png
  imgtool info /picture.exr | head -3'
cp "$root/picture.png" "${2:-/dev/null}"
echo "installed and rendered in a clean root"
