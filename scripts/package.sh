#!/bin/bash
# Debian packages of this repository, in build/package: hydrapod and python3-hydrapod. Installs what their
# build needs, as ./hydrapod does. Exit code 3: the set-up could not be done.
set -euo pipefail

me=package
root=$(cd -P -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/.." && pwd)
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"

lock package
ensure_packages "${packages_program[@]}" "${packages_python[@]}" "${packages_deb[@]}"
build_preset package
say "packing"
if ! (cd "$root/build/package" && logged cpack.log cpack -G DEB); then
  show_failure "$root/build/package/cpack.log"
fi
unlock
ls "$root"/build/package/*.deb
