#!/bin/bash
# A client of `hydrapod serve` in the shell (bash and coreutils): 200 steps of a slow motion.
#
#     hydrapod serve machine.toml --lock-step --layout integers.toml --once --patience 1s &
#     ./client.sh 127.0.0.1 4747
#
# Lock-step, as a shell takes milliseconds for a packet: the machine waits for every command. Prints
# the step, the demanded and the actual displacement in z [µm], and the length of leg 1 [µm].
set -euo pipefail
(($# == 2)) || { printf 'usage: %s ADDRESS PORT\n' "$0" >&2; exit 2; }
exec 3<>"/dev/udp/$1/$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# whole numbers of 32 bits, little-endian
words() {
  local word bytes all=
  for word; do
    printf -v bytes '\\x%02x\\x%02x\\x%02x\\x%02x' \
      $((word & 255)) $((word >> 8 & 255)) $((word >> 16 & 255)) $((word >> 24 & 255))
    all+=$bytes
  done
  # shellcheck disable=SC2059  # bytes
  printf "$all"
}

printf 'step,demand_um,platform_um,leg1_um\n'
for ((step = 1; step <= 200; ++step)); do
  z=$((step * 5))
  words 1 "$step" 0 0 "$z" 0 0 0 >numbers
  # the trailer of gzip begins with the checksum: crc32, little-endian
  gzip -c numbers | tail -c 8 | head -c 4 >checksum
  cat numbers checksum >packet
  cat packet >&3 # one write is one packet
  if ! timeout 2 dd bs=2048 count=1 <&3 >answer 2>/dev/null || [[ ! -s answer ]]; then
    printf 'no answer to step %d\n' "$step" >&2
    exit 1
  fi
  # magic, sequence, answered, state, six lengths, x, y, z
  read -r -a numbers < <(od -An -v -w256 -t d4 answer)
  if ((numbers[0] != 2 || numbers[2] != step)); then
    printf 'step %d was answered as %s\n' "$step" "${numbers[*]}" >&2
    exit 1
  fi
  if ((step % 20 == 0)); then printf '%d,%d,%d,%d\n' "$step" "$z" "${numbers[12]}" "${numbers[4]}"; fi
done
