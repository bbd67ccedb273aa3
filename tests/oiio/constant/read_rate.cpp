// SPDX-License-Identifier: Apache-2.0
// How fast whole images are read: read_rate NAME... prints Mpix/s and Mpix per second of processor time, each
// the best of several, of an ImageBuf that reads a whole image and of ImageCache::get_pixels. What a name
// reads from is in the cache by then.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/timer.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace {

struct Time {
    double wall = 1e30, processor = 1e30;
};

/// The best of several.
Time time_of(const std::function<void()>& body) {
    constexpr int kRepeats = 7;
    Time best;
    for (int i = 0; i < kRepeats; ++i) {
        const std::clock_t begin = std::clock();
        OIIO::Timer timer;
        body();
        best.wall = std::min(best.wall, timer());
        best.processor = std::min(best.processor, double(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    return best;
}

void check(bool ok, const std::string& error) {
    if (ok) return;
    std::fprintf(stderr, "%s\n", error.c_str());
    std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: read_rate NAME...\n");
        return 2;
    }
    auto cache = OIIO::ImageCache::create(true);
    cache->attribute("max_memory_MB", 4096.0f);
    for (int i = 1; i < argc; ++i) {
        const OIIO::ustring name(argv[i]);
        OIIO::ImageSpec spec;
        const Time whole = time_of([&] {
            OIIO::ImageBuf image(name);
            check(image.read(0, 0, true, OIIO::TypeFloat), image.geterror());
            spec = image.spec();
        });
        std::vector<float> pixels(static_cast<std::size_t>(spec.image_pixels()) * spec.nchannels, 0.0f);
        const Time cached = time_of([&] {
            cache->invalidate(name);
            check(cache->get_pixels(name, 0, 0, 0, spec.width, 0, spec.height, 0, 1, OIIO::TypeFloat,
                                    pixels.data()),
                  cache->geterror());
        });
        const double n = double(spec.image_pixels()) * 1e-6;
        std::printf("%-60s ImageBuf %6.0f (cpu %6.0f) Mpix/s, ImageCache %6.0f (cpu %6.0f)\n", argv[i],
                    n / whole.wall, n / whole.processor, n / cached.wall, n / cached.processor);
    }
    return 0;
}
