#!/bin/bash
# try-packages.sh SUITE FOLDER PACKAGE.deb...
#
# Makes a bare Debian SUITE (bookworm) in FOLDER, unless one is there, installs the packages of
# scripts/package.sh there with apt, and runs the program and the Python package in an empty folder.
# Needs root and debootstrap. MIRROR (default http://deb.debian.org/debian) may name another mirror.
set -euo pipefail

fewest=3
here=$(dirname -- "$(readlink -f -- "$0")")
# shellcheck source=tests/packaging/bare_root.sh
source "$here/bare_root.sh"
packages=("$@")

make_root
share_network_settings
rm -rf "${folder:?}/packages" "$folder/work"
mkdir "$folder/packages" "$folder/work"
cp -- "${packages[@]}" "$folder/packages/"

run /packages apt-get update
# shellcheck disable=SC2016
run /packages bash -c 'DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends ./*.deb gnuplot-nox man-db'

models=/usr/share/hydrapod/models
run /work hydrapod --version
run /work hydrapod check $models/heavy-platform.toml --plot check.png
run /work hydrapod modes $models/zhang-jiang-2021.toml
run /work hydrapod report $models/zhang-jiang-2021.toml -o report.html
run /work bash -c 'man hydrapod-modes | head -5'
run /work python3 -c "
import hydrapod
print(hydrapod.modes(hydrapod.read_machine('$models/zhang-jiang-2021.toml')).frequency_hz)"
in_root ls -l /work
# and the program is gone with its package
run /work bash -c 'apt-get remove --yes hydrapod python3-hydrapod && ! command -v hydrapod'
