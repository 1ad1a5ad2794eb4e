#!/bin/bash
# search_path.sh FILE... : every folder in which the files search for libraries must be absolute, or beside the file
set -euo pipefail
for file in "$@"; do
  found=$(readelf --dynamic --wide "$file" | sed -n 's/.*(R\(UN\)\?PATH).*\[\(.*\)\]$/\2/p')
  [[ -n $found ]] || continue
  while IFS= read -r -d : folder; do
    if [[ $folder != /* && $folder != \$ORIGIN* ]]; then
      printf "%s searches for libraries in '%s' (of '%s')\n" "$file" "$folder" "$found"
      exit 1
    fi
  done <<<"$found:"
done
