#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The one-liners of README.md and docs/, as they stand there, make the pictures they name. They are run in a tree of their own with the
# names of the real one, in which the demo's pictures are.
set -euo pipefail
examples="$ANAMORPH_SOURCE_DIR/examples"
blocks="$ANAMORPH_SOURCE_DIR/tests/docs/blocks.py"
rm -rf tree
mkdir -p tree/build/demo/out
ln -s "$ANAMORPH_BUILD_DIR" tree/build/release
cd tree/build/demo/out
"$PYTHON" "$examples/make_panorama.py" panorama.exr 512
"$PYTHON" "$examples/make_faces.py" round.png long.png faces.csv
"$PYTHON" "$examples/make_cube.py" label_ .png
cp -r "$examples/maps" .
cp "$examples/bulge.json" "$examples/relief.csv" "$examples/smile.csv" "$examples/frown.csv" "$examples/swirl.ps" "$examples/figures/walker.nudes" "$examples/figures/benzene.cif" .
lens="lens=brown:k1=-0.21,k2=0.05&fov=84"
oiiotool "panorama.exr.pano?to=rectilinear&size=2048x1556&$lens" -o plate.exr
oiiotool "panorama.exr.pano?to=rectilinear&size=600x400&pitch=-3&$lens" -o photo.jpg
cp plate.exr taken.exr
oiiotool panorama.exr --cut 300x150+60+40 -o part.exr
oiiotool panorama.exr --resize 256x256 -o square.exr
oiiotool "panorama.exr.pano?to=cylindrical&fov=360&size=256x64" -o slits.exr
oiiotool $(for i in {1..32}; do echo slits.exr; done) --mosaic 1x32 -o room.exr

"$PYTHON" "$blocks" oiio . >one_liners.sh
[ "$(wc -l <one_liners.sh)" -eq 88 ]
if ! command -v ffmpeg >/dev/null; then
    sed -i '/^ffmpeg /d' one_liners.sh
fi
(unset OIIO_LIBRARY_PATH && cd ../../.. && bash -ex build/demo/out/one_liners.sh </dev/null)
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
