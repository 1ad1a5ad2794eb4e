#!/bin/bash
# try-fresh-machine.sh SUITE FOLDER [COMMAND...]
#
# Makes a bare Debian SUITE (bookworm) in FOLDER, unless one is there, clones this repository's HEAD
# into it and starts COMMAND there as a person would after `git clone` (default: ./hydrapod --version,
# then ./test). Before that it checks that somebody who may not install packages is told what to run.
# Needs root, debootstrap and git. MIRROR (default http://deb.debian.org/debian) may name another one.
set -euo pipefail

fewest=2
here=$(dirname -- "$(readlink -f -- "$0")")
# shellcheck source=tests/packaging/bare_root.sh
source "$here/bare_root.sh"
commands=("$@")
inside=/root/hydrapod
repository=$(git -C "$here" rev-parse --show-toplevel)

clone() {
  step "git clone"
  rm -rf "${folder:?}$inside"
  git clone --quiet --no-hardlinks "$repository" "$folder$inside"
  git -C "$folder$inside" log -1 --format='%h %s'
}

# Not root, no sudo: exit code 3 and the command to run.
try_without_rights() {
  step "as nobody: ./hydrapod --version"
  local status=0
  cp -r "$folder$inside" "$folder/tmp/hydrapod-nobody"
  in_root chown -R nobody /tmp/hydrapod-nobody
  in_root setpriv --reuid=nobody --regid=nogroup --clear-groups \
    /tmp/hydrapod-nobody/hydrapod --version || status=$?
  rm -rf "$folder/tmp/hydrapod-nobody"
  echo "exit code $status, 3 expected"
  ((status == 3))
}

make_root
share_network_settings
clone
if [[ ! -x $folder/usr/bin/cmake ]]; then try_without_rights; fi
if ((${#commands[@]})); then
  run $inside "${commands[@]}"
else
  run $inside ./hydrapod --version
  run $inside ./hydrapod --version
  run $inside ./test
fi
