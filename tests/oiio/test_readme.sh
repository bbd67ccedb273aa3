#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The README's one-liners, as they stand there, make the pictures they name.
set -euo pipefail
readme="$ANAMORPH_SOURCE_DIR/README.md"
"$PYTHON" "$ANAMORPH_SOURCE_DIR/examples/make_panorama.py" panorama.exr 512

grep '^    oiiotool ' "$readme" >one_liners.sh
[ "$(wc -l <one_liners.sh)" -eq 5 ]
rm -f ./*.jpg
bash -ex one_liners.sh
for picture in view.jpg:480x360 planet.jpg:400x400 fisheye.jpg:400x400 cross.jpg:640x480 error.jpg:480x360; do
    iinfo "${picture%:*}" | tr -d ' ' | grep ":${picture#*:},3channel,uint8jpeg"
    [ -s "$ANAMORPH_SOURCE_DIR/examples/pictures/${picture%:*}" ]
done
