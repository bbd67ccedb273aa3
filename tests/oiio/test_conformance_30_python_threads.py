# SPDX-License-Identifier: Apache-2.0
"""Conformance item 30: recipes read from many Python threads at once, directly and through the shared cache."""
import threading

import OpenImageIO as oiio

source = oiio.ImageBuf(oiio.ImageSpec(256, 128, 3, "float"))
oiio.ImageBufAlgo.noise(source, "uniform", 0.0, 1.0, False, 7)
source.set_write_tiles(32, 32)
assert source.write("city.exr"), source.geterror()

with open("grid.json", "w") as file:
    file.write('{"columns": 1, "rows": 1, "vertices": [[0, 0], [240, 10], [10, 120], [250, 128]]}')
with open("lines.csv", "w") as file:
    file.write("60,30,180,40,80,20,190,60\n")

names = [f"city.exr.pano?size=96x64&tile=16&yaw={yaw}&pitch={yaw / 3}" for yaw in range(0, 360, 45)]
names += [f"x.pano?concatenate=0&size=96x64&src=y.pano?to=equirectangular&size=256x128&roll={roll}&src=city.exr" for roll in (20, 30)]
names += [f"city.exr.warp?mesh=grid.json&size=96x64&tile=16&amount={amount}" for amount in (0.5, 1)]
names += [f"city.exr.morph?b=(city.exr.warp?mesh=grid.json)&features=lines.csv&size=96x64&t={t}" for t in (0.2, 0.8)]


def pixels(name):
    image = oiio.ImageBuf(name)
    assert image.read(0, 0, True), image.geterror()
    return image.get_pixels("float").tobytes()


expected = {name: pixels(name) for name in names}
assert len(set(expected.values())) == len(names), "the views differ"
failures = []


def work(start):
    try:
        for i in range(12):
            name = names[(start + i) % len(names)]
            if i % 3 == 0:
                image = oiio.ImageInput.open(name)
                assert image, oiio.geterror()
                read = image.read_image("float").tobytes()
                image.close()
            elif i % 3 == 1:
                read = pixels(name)
            else:
                image = oiio.ImageBuf(name)
                read = image.get_pixels("float", oiio.get_roi(image.spec())).tobytes()
            assert read == expected[name], name
            assert oiio.ImageInput.open("city.exr.pano?size=none") is None
            assert "size=none" in oiio.geterror()
    except Exception as error:  # a thread's failure is the test's
        failures.append(repr(error))


threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert not failures, failures
print("8 threads,", len(names), "recipes: the same bits")
