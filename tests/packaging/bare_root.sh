# shellcheck shell=bash
# Sourced with the arguments of a script, SUITE FOLDER and more: a bare Debian in $folder, and commands in
# it. The comment at the top of the script is its usage; $fewest: so many arguments it needs. Takes the first
# two away. Needs root and debootstrap.

if (($# < ${fewest:?so many arguments})); then
  sed -n '2,/^$/{/^set /!s/^# \?//p}' "$0" >&2
  exit 2
fi
suite=$1
folder=$(realpath -m -- "$2")
shift 2
trust=()

step() { printf '\n--- %s\n' "$*"; }

# Unless one is there. MIRROR may name another mirror.
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

# A clean environment, as after a login; /proc and pseudo terminals in a mount namespace that ends with
# the command.
in_root() {
  # shellcheck disable=SC2016  # expanded by the shell inside
  unshare --mount --propagation private bash -c '
    mount -t proc proc "$1/proc" && mount -t devpts devpts "$1/dev/pts" && shift 1 && exec "$@"' _ "$folder" \
    env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root \
    TERM="${TERM:-dumb}" "${trust[@]}" chroot "$folder" "$@"
}

# run FOLDER COMMAND... : in this folder of the root
run() {
  local where=$1 began=$SECONDS
  shift
  step "$*"
  # shellcheck disable=SC2016
  in_root bash -c 'cd "$1" && shift && "$@"' _ "$where" "$@"
  echo "took $((SECONDS - began)) s"
}
