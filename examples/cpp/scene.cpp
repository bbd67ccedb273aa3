// SPDX-License-Identifier: Apache-2.0
// A panorama thrown onto two walls, a floor, and what stands before them, as a camera sees it from elsewhere; what is in a shadow is grey (Kim 2003, chapter 4):
//     example_scene [PANORAMA.ppm PICTURE.ppm]
// An equirectangular panorama; without names a checkered one, and no picture is written.
#include <anamorph/projector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

using namespace anamorph;

struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;  // rows from the top, red, green and blue

    glm::dvec3 at(int x, int y) const {
        const std::uint8_t* const p = &pixels[3 * (std::size_t{1} * y * width + x)];
        return {p[0], p[1], p[2]};
    }
    // Between the four nearest texels; across, the panorama closes on itself.
    glm::dvec3 bilinear(const Point<double>& texel) const {
        const double x = texel.x - 0.5, y = std::clamp(texel.y - 0.5, 0.0, height - 1.0);
        const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(y),
                  y1 = std::min(y0 + 1, height - 1);
        const int left = (x0 + width) % width, right = (x0 + 1) % width;
        const glm::dvec3 upper = glm::mix(at(left, y0), at(right, y0), x - x0);
        return glm::mix(upper, glm::mix(at(left, y1), at(right, y1), x - x0), y - y0);
    }
};

Image read_ppm(const std::string& name) {
    std::ifstream file(name, std::ios::binary);
    std::string kind;
    int most = 0;
    Image image;
    file >> kind >> image.width >> image.height >> most;
    file.get();
    if (!file || kind != "P6" || most != 255 || image.width < 1 || image.height < 1 || image.width > 65536 ||
        image.height > 65536)
        throw std::runtime_error(name + ": must be a PPM file (P6) of 8 bits");
    image.pixels.resize(std::size_t{3} * image.width * image.height);
    if (!file.read(reinterpret_cast<char*>(image.pixels.data()), std::ssize(image.pixels)))
        throw std::runtime_error(name + " ends too early");
    return image;
}

void write_ppm(const std::string& name, const Image& image) {
    std::ofstream file(name, std::ios::binary);
    file << "P6\n" << image.width << ' ' << image.height << "\n255\n";
    file.write(reinterpret_cast<const char*>(image.pixels.data()), std::ssize(image.pixels));
    if (!file.flush()) throw std::runtime_error(name + ": cannot be written");
}

Image checkers(int width, int height) {
    Image image{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const std::uint8_t c : {250, 160, 60})
                image.pixels.push_back((x / 32 + y / 32) % 2 ? std::uint8_t{230} : c);
    return image;
}

// The twelve triangles of a box, three corners each.
void add_box(const glm::dvec3& low, const glm::dvec3& high, std::vector<glm::dvec3>& corners) {
    const auto corner = [&](int i) {
        return glm::dvec3(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    };
    for (const std::array<int, 4>& side :
         {std::array{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
        for (const int i : {0, 1, 2, 0, 2, 3}) corners.push_back(corner(side[static_cast<std::size_t>(i)]));
}

struct Hit {
    double distance = 1e30;
    glm::dvec3 normal{0.0};
};

// The first triangle on a ray (Moeller and Trumbore 1997).
Hit first_hit(const std::vector<glm::dvec3>& corners, const glm::dvec3& from, const glm::dvec3& ray) {
    Hit hit;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const glm::dvec3 a = corners[i + 1] - corners[i], b = corners[i + 2] - corners[i],
                         s = from - corners[i];
        const glm::dvec3 p = glm::cross(ray, b), q = glm::cross(s, a);
        const double d = glm::dot(a, p), u = glm::dot(s, p) / d, v = glm::dot(ray, q) / d,
                     t = glm::dot(b, q) / d;
        if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < hit.distance)
            hit = {t, glm::normalize(glm::cross(a, b))};
    }
    return hit;
}

std::vector<glm::dvec3> make_scene() {
    std::vector<glm::dvec3> corners;
    add_box({-4, -0.1, -4}, {4, 0, 4}, corners);    // the floor
    add_box({-4, 0, -4.1}, {4, 3.6, -4}, corners);  // two walls
    add_box({-4.1, 0, -4}, {-4, 3.6, 4}, corners);
    add_box({-2.1, 0, -2.4}, {-1.6, 3.6, -1.9}, corners);  // two pillars and a block
    add_box({1.4, 0, -2.9}, {1.9, 3.6, -2.4}, corners);
    add_box({-0.5, 0, -2}, {0.4, 0.8, -1.1}, corners);
    return corners;
}

int main(int argc, char** argv) try {
    const bool has_files = argc == 3;
    const Image panorama = has_files ? read_ppm(argv[1]) : checkers(1024, 512);
    const std::vector<glm::dvec3> scene = make_scene();
    const Projector projector(Chart(Projection::equirectangular, panorama.width, panorama.height),
                              {.position = {0.2, 1.5, 1}, .direction = {-0.7, 0, -1}, .up = {0, 1, 0}});
    const Occluders occluders(scene, projector.pose().position);

    const glm::dvec3 eye{6.5, 4.6, 7}, ahead = glm::normalize(glm::dvec3(-0.3, 0.9, -0.9) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0))),
                     down = glm::cross(ahead, right);
    std::int64_t lit = 0, shadowed = 0;
    const auto colour_along = [&](const glm::dvec3& ray) {
        const Hit hit = first_hit(scene, eye, ray);
        if (hit.normal == glm::dvec3(0.0)) return glm::dvec3(40.0);
        // Walls are a little darker than the floor, so that corners show.
        const double bright = glm::dot(glm::abs(hit.normal), {0.75, 1, 0.9});
        const glm::dvec3 point = eye + ray * hit.distance;
        Point<double> texel{};
        if (occluders.hides(point) || projector.receive(point, texel) != Received::texel) {
            ++shadowed;
            return glm::dvec3(60 * bright);
        }
        ++lit;
        return bright * panorama.bilinear(texel);
    };

    const int fine = has_files ? 3 : 1;  // rays for each pixel, each way
    Image picture{480, 360, {}};
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            glm::dvec3 sum{0.0};
            for (int i = 0; i < fine * fine; ++i) {
                const double across = (x + (i % fine + 0.5) / fine) / 240 - 1,
                             below = (y + (i / fine + 0.5) / fine) / 180 - 1;
                sum += colour_along(ahead + 0.54 * across * right + 0.405 * below * down);
            }
            for (int c = 0; c < 3; ++c)
                picture.pixels.push_back(static_cast<std::uint8_t>(std::lround(sum[c] / (fine * fine))));
        }
    std::cout << lit << " rays see the panorama, " << shadowed << " shadows\n";
    if (has_files) write_ppm(argv[2], picture);
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
}
