#!/bin/bash
# try-fresh-machine.sh SUITE FOLDER [COMMAND...]
#
# Makes a bare Debian SUITE (bookworm) in FOLDER, unless one is there, clones this repository's HEAD
# into it and starts COMMAND there as a person would after `git clone` (default: ./hydrapod --version,
# then ./test). Before that it checks that somebody who may not install packages is told what to run.
# Needs root, debootstrap and git. MIRROR (default http://deb.debian.org/debian) may name another one.
set -euo pipefail

if (($# < 2)); then
  sed -n '2,7s/^# \?//p' "$0" >&2
  exit 2
fi
suite=$1
folder=$(realpath -m -- "$2")
shift 2
commands=("$@")
repository=$(git -C "$(dirname -- "$(readlink -f -- "$0")")" rev-parse --show-toplevel)
inside=/root/hydrapod
trust=()

step() { printf '\n--- %s\n' "$*"; }

# A clean environment, as after a login; /proc and pseudo terminals in a mount namespace that ends with
# the command.
in_root() {
  # shellcheck disable=SC2016  # expanded by the shell inside
  unshare --mount --propagation private bash -c '
    mount -t proc proc "$1/proc" && mount -t devpts devpts "$1/dev/pts" && shift 1 && exec "$@"' _ "$folder" \
    env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root \
    TERM="${TERM:-dumb}" "${trust[@]}" chroot "$folder" "$@"
}

make_root() {
  [[ -d $folder/usr ]] && return
  step "debootstrap --variant=minbase $suite"
  debootstrap --variant=minbase "$suite" "$folder" "${MIRROR:-http://deb.debian.org/debian}"
}

# What a machine on the same network has anyway: names, and trust in the network's own authority, if
# there is one and npm is told of it.
share_network_settings() {
  cp -L /etc/resolv.conf /etc/hosts "$folder/etc/"
  mkdir -p "$folder/usr/local/share"
  cp -r /usr/local/share/ca-certificates "$folder/usr/local/share/"
  if [[ -z ${NODE_EXTRA_CA_CERTS:-} ]]; then return; fi
  cp -L "$NODE_EXTRA_CA_CERTS" "$folder/etc/network-authority.crt"
  trust=(NODE_EXTRA_CA_CERTS=/etc/network-authority.crt)
}

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

run() {
  step "$*"
  local began=$SECONDS
  # shellcheck disable=SC2016
  in_root bash -c 'cd "$1" && shift && "$@"' _ "$inside" "$@"
  echo "took $((SECONDS - began)) s"
}

make_root
share_network_settings
clone
if [[ ! -x $folder/usr/bin/cmake ]]; then try_without_rights; fi
if ((${#commands[@]})); then
  run "${commands[@]}"
else
  run ./hydrapod --version
  run ./hydrapod --version
  run ./test
fi
