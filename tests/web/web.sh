#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/web/web.sh BUILD_DIR
# Builds the page by the preset web, has node draw the views of its list, and Chromium try the page itself, with the programs of BUILD_DIR, a
# build with hosts, for the desktop. Pictures of what Chromium shows are left in build/web/shots. Needs section [web] of packages.txt.
set -euo pipefail
if [ $# -ne 1 ]; then
    echo "usage: web.sh BUILD_DIR" >&2
    exit 1
fi
cd "$(dirname "$0")/../.."
# Debian's emscripten finds Debian's acorn with Debian's node alone.
export NODE_PATH=/usr/share/nodejs
cmake --preset web && cmake --build --preset web -j "$(nproc)"
node tests/web/node.cjs build/web/plugins/web plugins/web/worker.js plugins/web/hashes.txt build/web/anamorph.html
/usr/bin/python3 tests/web/test_page.py build/web/anamorph.html "$1/core/command/anamorph" build/web/shots
