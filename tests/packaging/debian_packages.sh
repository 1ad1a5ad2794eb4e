#!/bin/bash
# debian_packages.sh BUILD SCRATCH VERSION : packs the build and runs what is in the packages
set -euo pipefail
build=$1 scratch=$2 version=$3
rm -rf "$scratch"
mkdir -p "$scratch/root"
(cd "$build" && cpack -G DEB -B "$scratch") >"$scratch/log" || {
  cat "$scratch/log"
  exit 1
}

fail() {
  printf 'not as expected: %s\n' "$*"
  exit 1
}

architecture=$(dpkg --print-architecture)
for name in hydrapod python3-hydrapod; do
  file=$scratch/${name}_${version}_$architecture.deb
  [[ -f $file ]] || fail "no $file"
  [[ $(dpkg-deb --field "$file" Depends) == *"libsundials-cvode6"* ]] || fail "$name does not depend on SUNDIALS"
  dpkg-deb --extract "$file" "$scratch/root"
done

root=$scratch/root/usr
[[ $("$root/bin/hydrapod" --version) == "hydrapod $version" ]] || fail "version"
# relocatable: it runs from here with the machine files that lie beside it
(cd "$scratch" && "$root/bin/hydrapod" check "$root/share/hydrapod/models/heavy-platform.toml") >/dev/null
"$root/bin/hydrapod" --help | awk '/^Subcommands:/ { on = 1; next } on && NF == 0 { exit } on && /^  [a-z]/ { print $1 }' |
  while read -r command; do
    [[ -s $root/share/man/man1/hydrapod-$command.1 ]] || fail "no man page of $command"
  done
grep --quiet '^\.TH "HYDRAPOD\\-MODES"' "$root/share/man/man1/hydrapod-modes.1" || fail "page of modes"
PYTHONPATH=$root/lib/python3/dist-packages /usr/bin/python3 -c '
import hydrapod, sys
machine = hydrapod.read_machine(sys.argv[1])
assert len(hydrapod.modes(machine).frequency_hz) in (18, 30)
' "$root/share/hydrapod/models/heavy-platform.toml"
# completion: the words of bash for an unfinished line
complete_line() {
  # shellcheck source=/dev/null
  source "$root/share/bash-completion/completions/hydrapod"
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  _hydrapod
  printf '%s\n' "${COMPREPLY[*]}"
}
[[ $(complete_line hydrapod mo) == "modes montecarlo" ]] || fail "commands: $(complete_line hydrapod mo)"
[[ $(complete_line hydrapod record sh) == show ]] || fail "commands of record"
[[ $(complete_line hydrapod modes machine.toml --op) == --open-loop ]] || fail "options of modes"
[[ $(complete_line hydrapod help diag) == diagnose ]] || fail "commands behind help"
[[ -z $(complete_line hydrapod modes mach) ]] || fail "files are bash's business"
