#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/install_packages.sh SECTION...
# Installs the Debian packages of these sections of tests/packages.txt that are missing, as root or with sudo.
# Says which; when none is missing, it says and does nothing.
set -euo pipefail
list="$(dirname "$0")/packages.txt"

missing=()
for section in "$@"; do
    names="$(sed -n "/^\[$section\]$/,/^\[/{/^[a-z0-9]/p}" "$list")"
    if [ -z "$names" ]; then
        echo "install_packages.sh: no section [$section] in $list" >&2
        exit 1
    fi
    for name in $names; do
        if [ "$(dpkg-query -W -f '${db:Status-Status}' "$name" 2>/dev/null)" != installed ]; then
            missing+=("$name")
        fi
    done
done
[ ${#missing[@]} -gt 0 ] || exit 0

echo "installing: ${missing[*]}"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
log="$(mktemp)"
trap 'rm -f "$log"' EXIT
# Sources that are out of reach do no harm as long as the packages can be had.
"${as_root[@]}" apt-get -q update >"$log" 2>&1 || true
if ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -q -y --no-install-recommends install "${missing[@]}" >>"$log" 2>&1; then
    cat "$log" >&2
    exit 1
fi
