# shellcheck shell=bash disable=SC2154  # root and me come from the caller
# Set-up shared by ./hydrapod and ./test: installs what is missing, configures, builds. Sourced with
# `root` (the repository) and `me` (the name to speak under) set. All chatter goes to stderr, stdin is
# left alone. A set-up that cannot be done ends the caller with exit code 3.

# shellcheck source=scripts/packages.sh
source "$root/scripts/packages.sh"

readonly setup_failed=3

say() { printf '%s: %s\n' "$me" "$*" >&2; }

# lock name : waits until no other start does the same, and keeps others waiting until unlock or the
# end of this process. Children get no descriptor 9, or they would keep the lock.
lock() {
  if ! { mkdir -p "$root/build" && : >>"$root/build/.lock-$1"; } 2>/dev/null; then
    say "the sources are newer than the program in $root/build, or it was not built yet, and this folder"
    say "cannot be written: build it as a user who may, or copy the repository to a place of your own"
    exit "$setup_failed"
  fi
  exec 9>"$root/build/.lock-$1"
  flock --nonblock 9 && return
  say "waiting for another start that is building in $root/build"
  flock 9
}
unlock() { exec 9>&-; }

# --- Packages -------------------------------------------------------------------------------------

# missing_packages "package reason"... : those that are not installed, in the same form
missing_packages() {
  local entry installed tool
  installed=" $(dpkg-query --show --showformat='${db:Status-Status}:${Package} ' \
    "${@%% *}" 2>/dev/null || true)"  # it fails when it has never heard of one
  for entry in "$@"; do
    [[ $installed == *" installed:${entry%% *} "* ]] && continue
    tool=${tool_of[${entry%% *}]:-}
    [[ -n $tool && -n $(type -P "$tool") ]] || printf '%s\n' "$entry"
  done
}

# ensure_packages "package reason"... : installs what is missing, or says how to and ends
ensure_packages() {
  if [[ -z $(type -P dpkg-query) ]]; then
    require_tools
    return
  fi
  local missing entry
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  say "these Debian packages are missing:"
  for entry in "${missing[@]}"; do
    printf '  %-22s %s\n' "${entry%% *}" "${entry#* }" >&2
  done
  install_packages "${missing[@]%% *}"
}

# Without dpkg nothing can be said about packages; whoever has the tools may have the libraries too.
require_tools() {
  local tool
  for tool in c++ cmake ninja; do
    [[ -n $(type -P "$tool") ]] && continue
    say "'$tool' is missing, and there is no dpkg to install it; needed are these packages of Debian 12:"
    say "  ${packages_program[*]%% *}"
    exit "$setup_failed"
  done
}

# install_packages name... : as root or through sudo
install_packages() {
  local as_root=() command=(apt-get install --yes --no-install-recommends "$@")
  if ((EUID != 0)); then as_root=(sudo); fi
  if [[ -n ${HYDRAPOD_NO_INSTALL:-} ]] || ! may_install; then
    say "no permission to install them; run this command, then start again:"
    printf '  %s\n' "sudo apt-get update && sudo ${command[*]}" >&2
    exit "$setup_failed"
  fi
  say "installing them with: ${as_root[*]:+sudo }${command[*]}"
  as_root+=(env DEBIAN_FRONTEND=noninteractive)
  exec 8>"$root/build/.lock-packages"
  flock 8
  # an update that fails does not matter if the lists at hand still serve
  logged "$root/build/apt-update.log" "${as_root[@]}" apt-get update || true
  logged "$root/build/apt-install.log" "${as_root[@]}" "${command[@]}" \
    -o DPkg::Lock::Timeout=300 || installing_failed
  exec 8>&-
}

installing_failed() {
  say "installing failed; the ends of build/apt-update.log and build/apt-install.log:"
  tail --quiet --lines=15 "$root/build/apt-update.log" "$root/build/apt-install.log" >&2
  exit "$setup_failed"
}

# Root may; others with sudo, which asks for a password where there is a terminal to ask on.
may_install() {
  ((EUID == 0)) && return
  [[ -n $(type -P sudo) ]] || return
  [[ -t 2 ]] || sudo -n true 2>/dev/null
}

# logged file command... : both streams into the file
logged() {
  local file=$1
  shift
  "$@" </dev/null >"$file" 2>&1 8>&- 9>&-
}

# --- Build ----------------------------------------------------------------------------------------

# build_preset name [build preset] : configures and builds build/<name>, or a part of it; on failure shows
# the end of the log and ends
build_preset() {
  local preset=$1 part=${2:-$1} folder=$root/build/$1 began=$SECONDS
  local log=$folder/log
  forget_moved_build "$folder"
  mkdir -p "$folder"
  use_ccache
  if [[ ! -f $folder/build.ninja || $root/CMakePresets.json -nt $folder/build.ninja ]]; then
    say "configuring build/$preset"
    (cd "$root" && logged "$log" cmake --preset "$preset") || show_failure "$log"
  fi
  [[ -t 2 ]] || say "building build/$preset"
  if ! run_build "$part" | tee "$log" | show_progress "$part"; then
    show_failure "$log"
  fi
  if ((SECONDS - began > 2)); then say "built build/$preset in $((SECONDS - began)) s"; fi
}

run_build() { (cd "$root" && cmake --build --preset "$1" -j "$(jobs_at_once)") </dev/null 2>&1 9>&-; }

# A build folder knows its absolute path: after the repository was moved it must be made anew.
forget_moved_build() {
  local cache=$1/CMakeCache.txt
  [[ -f $cache ]] || return 0
  grep --quiet --line-regexp --fixed-strings "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache" ||
    rm -rf "${1:?}"
}

# Its cache stands in the home folder, and in build/ for those who have none.
use_ccache() {
  if [[ -z ${CCACHE_DIR:-} && ! -w ${HOME:-/nonexistent} ]]; then
    export CCACHE_DIR=$root/build/ccache
  fi
}

# As many compilers as there are processors, and gigabytes of free memory.
jobs_at_once() {
  local kilobytes jobs
  jobs=$(nproc)
  kilobytes=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)
  if ((kilobytes / 1000000 < jobs)); then jobs=$((kilobytes / 1000000)); fi
  echo $((jobs > 0 ? jobs : 1))
}

# show_progress preset : ninja's lines in, on a terminal one line that is rewritten
show_progress() {
  local line
  while IFS= read -r line; do
    if [[ -t 2 && $line == \[* ]]; then printf '\r\033[K%s: %s %s' "$me" "$1" "${line%% *}" >&2; fi
  done
  if [[ -t 2 ]]; then printf '\r\033[K' >&2; fi
}

# show_failure log : the first error and what follows it, then the end of this process
show_failure() {
  local pattern='error:|undefined reference|CMake Error' command_line=' -E env CCACHE_'
  say "building failed; the whole log is $1"
  { grep --extended-regexp --max-count=1 --before-context=2 --after-context=40 "$pattern" "$1" ||
    tail --lines=40 "$1"; } | grep --invert-match --fixed-strings -e "$command_line" >&2
  exit "$setup_failed"
}
