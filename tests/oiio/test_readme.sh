#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The one-liners of README.md and docs/, as they stand there, make the pictures they name. They are run in a tree of their own with the
# names of the real one, in which the demo's pictures are.
set -euo pipefail
examples="$ANAMORPH_SOURCE_DIR/examples"
blocks="$ANAMORPH_SOURCE_DIR/tests/docs/blocks.py"
rm -rf drawn
mkdir drawn
"$PYTHON" "$ANAMORPH_SOURCE_DIR/docs/site/draw.py" "$ANAMORPH_SOURCE_DIR" "$ANAMORPH_BUILD_DIR" drawn
[ "$("$PYTHON" "$blocks" oiio | wc -l)" -eq 88 ]
cd drawn/tree/build/demo/out
for picture in view.jpg:480x360 planet.jpg:400x400 fisheye.jpg:400x400 cross.jpg:640x480 error.jpg:480x360 \
    warp.jpg:480x480 morph.jpg:480x480 lines.jpg:480x480 turn.jpg:480x480; do
    iinfo "${picture%:*}" | tr -d ' ' | grep ":${picture#*:},3channel,uint8jpeg"
    [ -s "$examples/pictures/${picture%:*}" ]
done
iinfo walker.png | tr -d ' ' | grep ":512x512,4channel,uint8png"
[ -s "$examples/pictures/walker.png" ]
iinfo outline.png | tr -d ' ' | grep ":1000x1000,4channel"
iinfo benzene.png | tr -d ' ' | grep ":1000x1000,4channel"
[ "$(ls walk.*.png | wc -l)" -eq 49 ]
[ -s both.jpg ]
iinfo view.exr | tr -d ' ' | grep ":640x480,3channel"
iinfo hardware.exr | tr -d ' ' | grep ":480x360,"
[ -s shaded.png ]
[ -s swirled.png ]
[ -s straight.jpg ]
iinfo twirl.jpg | tr -d ' ' | grep ":480x480,3channel,uint8jpeg"
iinfo unrolled.jpg | tr -d ' ' | grep ":480x240,3channel,uint8jpeg"
iinfo tin.jpg | tr -d ' ' | grep ":480x480,3channel,uint8jpeg"
iinfo saddle.jpg | tr -d ' ' | grep ":480x480,3channel,uint8jpeg"
iinfo moebius.jpg | tr -d ' ' | grep ":480x480,3channel,uint8jpeg"
[ "$(ls flag.*.jpg | wc -l)" -eq 12 ]
iinfo ripple_error.exr | tr -d ' ' | grep ":480x480,1channel"
[ -s film.mp4 ] || ! command -v ffmpeg
# The distortion taken off and put on again, but for what is filtered twice; by way of a larger picture.
iinfo flat.exr | grep -v 2048
iinfo -v flat.exr | grep "full/display size: 2048 x 1556"
oiiotool "plate.exr.lens?lens=3de4:k1=0.02&size=all" -o by_lens.exr
idiff -fail 0.02 -failpercent 1 -hardfail 20 -warn 20 undistorted.exr by_lens.exr
iinfo map.exr | tr -d ' ' | grep ":2048x1556,2channel"
idiff -fail 0.02 -failpercent 1 -hardfail 20 -warn 20 plate.exr taken.exr  # the sun is 490
[ "$(ls film.*.jpg | wc -l)" -eq 25 ]
[ "$(ls step.*.jpg | wc -l)" -eq 5 ]
oiiotool --info -v bent.exr | grep "anamorph:chain: \"warp of pano of lens\""
oiiotool --info -v of_part.exr | grep "a part of 8000x4000 at 1200,900"
[ -s of_square.exr ]
# Six files, which were written face by face, show what the panorama shows.
oiiotool "panorama.exr.pano?fov=100&yaw=30&size=480x360" -o of_whole.exr
idiff -fail 0.1 -failpercent 3 -hardfail 999 -warn 999 of_six.exr of_whole.exr
iinfo cubes.png | tr -d ' ' | grep ":1152x384,3channel,uint8png"
[ -s "$examples/pictures/cubes.png" ]
oiiotool --info -v padded.exr | grep 'panoramaProjection: "eac fov=90 padding=8"'
oiiotool --info -v seam.exr | grep 'anamorph:from: "dual_fisheye (as panoramaProjection says)"'
# The film's ends are the pictures, but for what JPEG loses by writing them again.
idiff -fail 0.05 -failpercent 1 -hardfail 0.3 -warn 1 film.0000.jpg round.png
idiff -fail 0.05 -failpercent 1 -hardfail 0.3 -warn 1 film.0024.jpg long.png
idiff -fail 0 film.0012.jpg morph.jpg
idiff -fail 0 step.0003.jpg morph.jpg
# The file view.pano is what its keys are in a name; a bump and a page that turns change the picture.
oiiotool "panorama.exr.pano?to=rectilinear&fov=100&yaw=160" -o from_a_name.png
idiff -fail 0 from_a_file.png from_a_name.png
for changed in raised turning; do
    if idiff -q -fail 0.1 -failpercent 1 -warn 0.1 $changed.png round.png; then
        exit 1
    fi
done
