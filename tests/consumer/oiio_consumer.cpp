// SPDX-License-Identifier: Apache-2.0
// A user of the installed OpenImageIO functions: a view out of a small panorama.
#include <anamorph/oiio_ops.h>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <iostream>

int main() {
    const OIIO::ImageSpec panorama(64, 32, 3, OIIO::TypeFloat);
    OIIO::ImageBuf source(panorama);
    OIIO::ImageBufAlgo::fill(source, {0.25f, 0.5f, 0.75f});

    OIIO::ParamValueList options;
    options.attribute("from", "equirectangular");
    options.attribute("to", "rectilinear");
    options.attribute("size", "16x16");
    OIIO::ImageBuf view;
    if (!anamorph::reproject(view, source, options)) {
        std::cerr << view.geterror() << "\n";
        return 1;
    }
    std::cout << view.spec().width << "x" << view.spec().height << "\n";
    return view.spec().width == 16 && view.spec().height == 16 ? 0 : 1;
}
