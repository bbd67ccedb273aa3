// SPDX-License-Identifier: Apache-2.0
// write_sample HEIGHT FILE.ppm writes the page's panorama, for programs that read files.
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>

#include "sample.h"

int main(int argc, char** argv) {
    if (argc != 3) {
        std::cerr << "usage: write_sample HEIGHT FILE.ppm\n";
        return 1;
    }
    try {
        const int height = std::atoi(argv[1]);
        const std::vector<std::uint8_t> rgba = anamorph::web::sample_panorama(height);
        std::ofstream file(argv[2], std::ios::binary);
        file << "P6\n" << 2 * height << " " << height << "\n255\n";
        for (std::size_t i = 0; i < rgba.size(); i += 4)
            file.write(reinterpret_cast<const char*>(rgba.data() + i), 3);
        if (file.flush()) return 0;
        std::cerr << "write_sample: " << argv[2] << " cannot be written\n";
    } catch (const std::exception& error) {
        std::cerr << "write_sample: " << error.what() << "\n";
    }
    return 1;
}
