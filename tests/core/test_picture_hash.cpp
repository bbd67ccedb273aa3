// SPDX-License-Identifier: Apache-2.0
// Small pictures of every operation have the hashes of tests/data/picture_hashes.txt, on every processor and instruction set.
//
// Decoders, OpenColorIO and OpenGL are none of it: what they compute is their own affair. Where a formula is right to change a picture,
// the test says the new lines, and writes them all to the file that ANAMORPH_WRITE_HASHES names.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "anamorph/deform/deform_kernels.h"
#include "anamorph/deform/deformed_surface.h"
#include "anamorph/image/block_sampler.h"
#include "anamorph/image/picture_hash.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/operation/operation.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::test_picture_hash {
namespace {

/// Whole numbers that look random, of the places of numbers, with no help of a library.
std::uint32_t noise(std::uint32_t place, std::uint32_t seed) {
    std::uint32_t n = place * 0x9e3779b1u + seed * 0x85ebca77u;
    n = (n ^ (n >> 15)) * 0x2c1b3c6du;
    n = (n ^ (n >> 12)) * 0x297a2d39u;
    return n ^ (n >> 15);
}

/// The binary16 of 0.5 to 1 in steps of 2^-11, and of what is below: 0 to 0.5 in steps of 2^-12, in units of 2^-12.
std::uint16_t half_of(std::uint32_t units) {
    units &= 0xfff;
    if (units == 0) return 0;
    int exponent = 11;
    while (units < 0x800) units <<= 1, --exponent;
    return static_cast<std::uint16_t>(((exponent + 3) << 10) | ((units >> 1) & 0x3ff));
}

/// An image of noise, of which a third is even, and, where asked for, some texels are infinite or no numbers.
class NoiseImage {
  public:
    NoiseImage(PixelType type, const Size& size, int channels, std::uint32_t seed, bool odd_texels)
        : m_bytes(static_cast<std::size_t>(size.width * size.height * channels * size_of(type))),
          m_view(packed_view(static_cast<const std::byte*>(m_bytes.data()), type, size.width, size.height,
                             channels)) {
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x)
                for (int c = 0; c < channels; ++c) {
                    const bool even = (x / 8 + y / 8) % 3 == 0;
                    const auto place = static_cast<std::uint32_t>(even ? (y / 8) * 512 + x / 8 : y * 512 + x);
                    std::uint32_t n = noise(place * 8 + static_cast<std::uint32_t>(c), seed);
                    set((static_cast<std::size_t>(y * size.width + x)) * static_cast<std::size_t>(channels) +
                            static_cast<std::size_t>(c),
                        n, odd_texels && n % 97 == 0);
                }
    }
    NoiseImage(const NoiseImage&) = delete;
    NoiseImage& operator=(const NoiseImage&) = delete;
    const ConstImageView& view() const { return m_view; }

  private:
    template <class T>
    void put(std::size_t i, T value) {
        std::memcpy(m_bytes.data() + i * sizeof(T), &value, sizeof(T));
    }
    void set(std::size_t i, std::uint32_t n, bool odd) {
        switch (m_view.type) {
            case PixelType::uint8:
                return put(i, static_cast<std::uint8_t>(n >> 24));
            case PixelType::uint16:
                return put(i, static_cast<std::uint16_t>(n >> 16));
            case PixelType::half:
                return put(i, odd ? static_cast<std::uint16_t>(n & 1 ? 0x7c00 : 0x7e00) : half_of(n >> 20));
            case PixelType::float32:
                return put(
                    i, odd ? (n & 1 ? HUGE_VALF : NAN) : static_cast<float>(n >> 8) * 0x1.8p-24f - 0.125f);
        }
    }

    std::vector<std::byte> m_bytes;
    ConstImageView m_view;
};

/// Files beside recipes: examples' own, and some more.
class Files final : public SideFileReader {
  public:
    Files() {
        for (const Operation* operation : operations())
            for (const auto& [name, text] : operation->example.files) m_texts[name] = text;
        m_texts["dress.nudes"] = m_texts["doll.nudes"];
        std::string& dress = m_texts["dress.nudes"];
        dress.insert(dress.rfind("stop"), "repeat 0 1 texture body cloth.png 0 0\n");
        m_texts["points.csv"] =
            "x,y,u,v\n5,5,8,6\n90,7,84,3\n40,30,47,35\n8,58,4,60\n88,60,92,55\n60,20,55,24\n";
        m_texts["push.json"] = R"({"columns": 2, "rows": 1, "units": "fractions", "direction": "push",
            "vertices": [[0.1, 0.05], [0.5, 0], [0.9, 0.1], [0, 1], [0.55, 0.93], [1, 0.95]]})";
    }
    std::string text(const std::string& name) const override {
        const auto found = m_texts.find(name);
        if (found == m_texts.end()) throw Error("there is no file " + name);
        return found->second;
    }
    bool exists(const std::string& name) const override {
        return m_texts.contains(name) || name == "cloth.png";
    }

    /// Source points that lie beside the middles of pixels.
    class StMap final : public SideImage {
      public:
        Size size() const override { return {48, 32}; }
        int channels() const override { return 2; }
        std::vector<float> read(int) override {
            std::vector<float> values;
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 48; ++x) {
                    const float s = (static_cast<float>(x) + 0.5f) / 48,
                                t = (static_cast<float>(y) + 0.5f) / 32;
                    values.push_back(s + 0.25f * s * (1 - s) * t);
                    values.push_back(t - 0.2f * t * (1 - t) * s);
                }
            return values;
        }
    };
    std::unique_ptr<SideImage> image(const std::string&, const std::string&) const override {
        return std::make_unique<StMap>();
    }

  private:
    std::map<std::string, std::string> m_texts;
};

/// How a picture is drawn: of what, and with which keys besides.
struct Way {
    PixelType type = PixelType::float32;
    std::string filter = {};
    int channels = 3;
    bool odd_texels = false, unassociated = false;
};

const char* name_of(PixelType type) {
    constexpr const char* kNames[] = {"uint8", "uint16", "half", "float"};
    return kNames[static_cast<int>(type)];
}

std::string line_name(const std::string& recipe, const Way& way) {
    return recipe + (way.filter.empty() ? "" : "&filter=" + way.filter) + " " + name_of(way.type) + " " +
           std::to_string(way.channels) + (way.odd_texels ? " odd" : "") +
           (way.unassociated ? " unassociated" : "");
}

PictureHash hash_of(const std::vector<std::byte>& numbers, PixelType type) {
    PictureHasher hasher;
    hasher.add_numbers(numbers, {size_of(type), type == PixelType::half || type == PixelType::float32});
    return hasher.hash();
}

/// Draws the first frame of a recipe, OPERATION?KEYS.
PictureHash hash_of_recipe(const std::string& recipe, const Way& way) {
    static const Files reader;
    const std::size_t mark = recipe.find('?');
    const Operation& operation = *find_operation(recipe.substr(0, mark));
    ParameterValues values(*operation.parameters);
    values.assign(parse_recipe_name(recipe.substr(mark)).assignments);
    if (!way.filter.empty()) values.assign({{"filter", way.filter}});
    SideFiles files;
    for (const LinkedFile& file : operation.named_files(values))
        files[file.key] = {file.name, "", file.image};
    LinkedFiles linked;
    if (operation.linked) linked = operation.linked(values, files, reader);
    for (const LinkedFile& file : linked) files[file.key] = {file.name, "", file.image};

    const Size size = operation.name == "mosaic" ? Size{192, 64} : Size{128, 64};
    std::vector<SourceImage> facts(operation.least_sources);
    for (SourceImage& source : facts) {
        source.facts.width = size.width;
        source.facts.height = size.height;
        source.channels = way.channels;
        source.alpha = way.unassociated ? 3 : -1;
        source.facts.has_alpha = way.unassociated;
    }
    const std::unique_ptr<const Pictures> pictures = operation.read({values, facts, files, reader});
    const PictureRequest request = *pictures->picture(0, 0);

    std::vector<std::unique_ptr<NoiseImage>> images;
    std::vector<std::unique_ptr<Source>> kept;
    std::vector<const Source*> sources;
    const auto add = [&](bool over) {
        images.push_back(std::make_unique<NoiseImage>(
            way.type, size, way.channels, static_cast<std::uint32_t>(images.size()) + 1, way.odd_texels));
        kept.push_back(std::make_unique<MemorySource>(images.back()->view(), way.unassociated ? 3 : -1));
        if (over)
            if (std::unique_ptr<Source> other = pictures->over_source(sources.size(), *kept.back()))
                kept.push_back(std::move(other));
        const SourceFaces faces = sources.empty() ? pictures->faces() : SourceFaces{};
        kept.push_back(std::make_unique<Pyramid>(*kept.back(), faces.columns, faces.rows));
        sources.push_back(kept.back().get());
    };
    for (std::size_t i = 0; i < facts.size(); ++i) add(true);
    for (const LinkedFile& file : linked)
        if (file.image) add(false);

    const bool colour = request.pixels == PixelKind::color && request.channels.empty();
    const PixelType type = colour ? way.type : PixelType::float32;
    const int channels = request.pixels == PixelKind::point    ? 2
                         : request.pixels == PixelKind::vector ? 3
                         : request.pixels == PixelKind::value  ? 1
                         : !request.channels.empty()           ? static_cast<int>(request.channels.size())
                                                               : way.channels + request.adds_alpha;
    std::vector<std::byte> pixels(
        static_cast<std::size_t>(request.size.width * request.size.height * channels * size_of(type)));
    const Box whole{0, 0, request.size.width, request.size.height};
    if (!request.solve()->draw(sources, whole, packed_view(pixels.data(), type, whole.x1, whole.y1, channels),
                               serial_for))
        throw Error("a source cannot be read");
    return hash_of(pixels, type);
}

/// Recipes in which something else is computed; the keys of filters are put to them.
const std::vector<std::string>& recipes() {
    static const std::vector<std::string> list = {
        "pano?to=rectilinear&fov=90&yaw=40&pitch=20&size=96x64",
        "pano?to=rectilinear&fov=25&yaw=170&pitch=-60&roll=12&size=96x64",
        "pano?to=rectilinear&fov=110&yaw=-80&size=40x30",
        "pano?to=rectilinear&fov=90&yaw=40&size=64x48&scheme=exact",
        "pano?to=rectilinear&fov=90&yaw=40&size=64x48&tol=0",
        "pano?to=rectilinear&fov=90&yaw=40&size=64x48&scheme=blocks&tol=0.2",
        "pano?to=rectilinear&fov=90&yaw=40&size=64x48&scheme=residual",
        "pano?to=rectilinear&fov=90&yaw=40&size=64x48&scheme=direct",
        "pano?to=fisheye&fov=180&pitch=90&size=64",
        "pano?to=equisolid&fov=200&yaw=10&size=64",
        "pano?to=stereographic&fov=220&pitch=-90&size=64",
        "pano?to=mercator&yaw=33&vfov=150&size=96",
        "pano?to=cylindrical&pitch=30&vfov=80&size=96",
        "pano?to=cubemap&yaw=20&size=32x192",
        "pano?to=eac&size=96x64",
        "pano?to=pannini&fov=150&yaw=50&size=96x64",
        "pano?to=hammer&yaw=100&size=96x48",
        "pano?to=equirectangular&yaw=45&pitch=45&roll=45&size=128x64",
        "pano?from=fisheye&srcfov=190&to=rectilinear&fov=80&yaw=20&size=64x48",
        "pano?from=rectilinear&srcfov=80&to=rectilinear&fov=50&yaw=15&pitch=8&size=64x48&wrap=black",
        "pano?from=rectilinear&srcfov=80&to=rectilinear&lens=brown:k1=-0.1,k2=0.02&fov=70&size=64x48&alpha=1",
        "mosaic?from=equirectangular&to=equirectangular&x=0.4&z=0.3&depth=4&pitch=20&size=96x48",
        "mosaic?circles=2&from=cylindrical&x=0.3&z=-0.2&yaw=70&fov=80&size=64x48",
        "lens?fov=120&lens=kb4:k1=0.05,k2=0.01",
        "lens?fov=70&lens=brown:k1=-0.15,k2=0.03,p1=0.001&mode=distort&size=96x48",
        "lens?fov=70&lens=ptlens:a=0.01,b=-0.05,c=0.02&tol=0",
        "lens?fov=80&lens=division:k1=-0.1&scheme=residual&alpha=1",
        "map?let=w=(0.6+frame)*exp(-4*r^2)&u=width/2+height/2*r*cos(a+w)&v=height/2-height/2*r*sin(a+w)",
        "map?u=x+5*sin(y/7)&v=y+3*cos(x/9)&scheme=exact",
        "map?u=x+5*sin(y/7)&v=y+3*cos(x/9)&scheme=direct&size=96x48",
        "map?u=width*s^1.3&v=height*t^0.8&wrap=mirror",
        "map?u=x+2*sin(y/9)&v=y+2*cos(x/9)&direction=push",
        "warp?mesh=grid.json",
        "warp?mesh=grid.json&scheme=exact&amount=0.7",
        "warp?mesh=grid.json&tol=0",
        "warp?mesh=grid.json&scheme=residual",
        "warp?mesh=push.json",
        "warp?mesh=map.exr",
        "warp?mesh=map.exr&step=4&size=96x64",
        "warp?points=points.csv",
        "warp?mesh=grid.json&scheme=hardware&machine=kim-2003",
        "morph?features=lines.json&t=0.4",
        "morph?features=lines.json&t=0.7&t_color=0.2&tol=0",
        "morph?features=lines.json&scheme=exact&weight_b=1.3&weight_p=0.3",
        "morph?features=lines.json&picture=a&t=0.6",
        "drape?surface=cylinder&angle=120&camera=0.4,0.3,2.5&size=64x48",
        "drape?surface=sphere&camera=0.8,0.5,2.2&size=64x48&scheme=exact",
        "drape?surface=torus&camera=0.4,1.2,2.5&size=64x48&shading=phong&light=1,1,1&specular=0.4",
        "drape?surface=waves&camera=-0.6,0.4,2.4&size=64x48&shading=gouraud&background=0.2,0.3,0.4",
        "drape?surface=cylinder&angle=90&camera=0.4,0.3,2.5&size=48x32&scheme=oka",
        "drape?surface=cylinder&angle=90&camera=0.4,0.3,2.5&size=48x32&scheme=oka-z",
        "drape?surface=cylinder&angle=90&camera=0.4,0.3,2.5&size=48x32&scheme=hardware&machine=oka-1987",
    };
    return list;
}

/// Recipes that need no more than one type and one filter each: the other projections, schemes and surfaces, and views whose blocks or
/// pixels lie on ties of rounding, where a number that is off by its last bit shows.
const std::vector<std::string>& further_recipes() {
    static const std::vector<std::string> list = {
        "pano?to=cubemap3x2&yaw=20&pitch=15&size=96x64",
        "pano?to=cubecross&yaw=20&pitch=15&size=64x48",
        "pano?to=orthographic&yaw=20&pitch=15&size=63",
        "pano?to=sinusoidal&yaw=20&pitch=15&size=96x48",
        "pano?to=dual_fisheye&yaw=20&pitch=15&size=96x48",
        "pano?to=dual_fisheye_tb&yaw=20&pitch=15&size=48x96",
        "pano?to=octahedral&yaw=20&pitch=15&size=64",
        "pano?to=mirror_ball&yaw=20&pitch=15&size=64",
        "pano?to=unified&d=0.9&fov=150&size=96x64",
        "pano?to=eucm&e=0.6&d=1.1&fov=150&size=96x64",
        "pano?to=double_sphere&e=0.5&d=-0.2&fov=150&size=96x64",
        "pano?to=formula&ray_x=sin(s)&ray_y=t&ray_z=cos(s)&size=64",
        "pano?from=cylindrical&srcfov=200&to=fisheye&fov=180&size=64",
        "pano?from=equisolid&to=fisheye&fov=180&size=64",
        "pano?from=stereographic&to=fisheye&fov=180&size=64",
        "pano?from=mercator&to=fisheye&fov=180&size=64",
        "pano?from=pannini&srcfov=150&to=fisheye&fov=180&size=64",
        "pano?from=orthographic&to=fisheye&fov=180&size=64",
        "pano?from=sinusoidal&to=fisheye&fov=180&size=64",
        "pano?from=hammer&to=fisheye&fov=180&size=64",
        "pano?from=dual_fisheye&to=fisheye&fov=180&size=64",
        "pano?from=mirror_ball&to=fisheye&fov=180&size=64",
        "pano?from=unified&srcd=0.9&srcfov=150&to=fisheye&fov=180&size=64",
        "pano?from=eucm&srce=0.6&srcd=1.1&srcfov=150&to=fisheye&fov=180&size=64",
        "pano?from=double_sphere&srce=0.5&srcd=-0.2&srcfov=150&to=fisheye&fov=180&size=64",
        "pano?to=rectilinear&fov=90&size=64&scheme=hardware&machine=embm-2003&reached=1",
        "mosaic?circles=1&from=cylindrical&x=0.3&z=-0.2&yaw=70&fov=80&size=64x48&scheme=exact",
        "mosaic?circles=1&from=cylindrical&x=0.3&z=-0.2&yaw=70&fov=80&size=64x48&scheme=blocks",
        "mosaic?circles=1&from=cylindrical&x=0.3&z=-0.2&yaw=70&fov=80&size=64x48&scheme=residual",
        "lens?fov=80&lens=brown:k1=-0.15,k2=0.03&scheme=exact",
        "lens?fov=80&lens=brown:k1=-0.15,k2=0.03&scheme=blocks",
        "lens?fov=106&lens=ptlens:b=0.153&mode=distort&size=320&tol=0.1",
        "lens?fov=57&lens=poly:k2=0.23&mode=distort&size=320&tol=0.1",
        "lens?fov=83&lens=poly:k2=-0.04&mode=distort&size=320x160&tol=0.001",
        "lens?fov=80&lens=ptlens:b=-0.1&mode=distort&size=360",
        "map?u=x+5*sin(y/7)&v=y+3*cos(x/9)&scheme=blocks",
        "map?u=x+5*sin(y/7)&v=y+3*cos(x/9)&scheme=residual",
        "map?u=width*(0.5+0.3*exp(-r)*log(2+px^2))&v=height*(0.5+0.4*asinh(py))",
        "warp?mesh=grid.json&scheme=hermite",
        "morph?features=lines.json&t=0.4&scheme=hardware",
        "drape?surface=plane&camera=0.4,0.3,2.5&size=64x48",
        "drape?surface=page_turn&camera=0.4,0.3,2.5&size=64x48",
        "drape?surface=ripples&camera=0.4,0.3,2.5&size=64x48",
        "drape?surface=waves&blend=ripples,sphere&weights=0.4,0.6&camera=0.4,0.3,2.5&size=64x48",
        "pano?to=orthographic&yaw=88&pitch=-16&roll=28&size=133&filter=antialias&tol=0.1",
        "pano?to=equirectangular&yaw=13&size=320x180&filter=nearest&tol=0.001",
        "pano?to=fisheye&fov=180&yaw=45&size=128&filter=nearest&tol=0.1",
        // Corners of pixels on a rim, and points that lie exactly between two texels, by the last bit of a distance.
        "pano?to=orthographic&yaw=150&size=28x96&filter=antialias&tol=0.001",
        "pano?to=orthographic&fov=180&yaw=60&pitch=-20&size=100&filter=antialias&tol=0.001",
        "pano?to=equirectangular&fov=360&yaw=121&size=160x90&filter=nearest&scheme=exact",
        "pano?to=sinusoidal&yaw=52&pitch=45&size=160x90&filter=antialias",
    };
    return list;
}

/// Recipes of figures, which have no sources but textures.
const std::vector<std::string>& figure_recipes() {
    static const std::vector<std::string> list = {
        "figure?script=doll.nudes&frame=1&size=64",
        "figure?script=doll.nudes&frame=1&size=64&lighting=lambert&light=1,1,-1",
        "figure?script=doll.nudes&frame=1&size=64&lighting=blinn&specular=0.6&shininess=17.5",
        "figure?script=doll.nudes&frame=1&size=64&antialias=0&perturbation=0.1&seed=3&perspective=1500",
        "figure?script=doll.nudes&frame=1&size=64&style=outline",
        "figure?script=doll.nudes&frame=1&size=64&style=stick&line_colors=1",
        "figure?script=doll.nudes&frame=1&size=64&style=depth",
        "figure?script=doll.nudes&frame=1&size=64&style=id",
        "figure?script=doll.nudes&frame=1&size=64&style=uv",
        "figure?script=doll.nudes&frame=1&size=64&style=uv&mapping=octahedral",
        "figure?script=dress.nudes&frame=1&size=64&style=textured",
        "figure?script=dress.nudes&frame=1&size=64&style=textured&filter=trilinear&mapping=linear",
        "figure?script=dress.nudes&frame=1&size=64&style=textured&filter=summed_area&mapping=octahedral",
        "figure?script=dress.nudes&frame=1&size=64&style=textured&filter=bicubic&mapping=mirrored",
    };
    return list;
}

/// What a recipe's filter may be, but for those that ask for tables of their own, and for the sharp cubic, which has cases of its own.
std::vector<std::string> filters_of(const std::string& recipe) {
    const Operation& operation = *find_operation(recipe.substr(0, recipe.find('?')));
    std::vector<std::string> filters;
    for (const Parameter& p : *operation.parameters)
        if (p.name == "filter")
            for (const auto& choice : p.choices)
                if (choice != "sharp_bicubic") filters.emplace_back(choice);
    if (recipe.find("scheme=oka") != std::string::npos || recipe.find("hardware") != std::string::npos)
        return {""};
    return filters;
}

struct Case {
    std::string recipe;
    Way way;
};

/// Each recipe with each type and each filter, though not with each of both: what is left out another recipe has.
std::vector<Case> cases() {
    std::vector<Case> list;
    constexpr PixelType kTypes[] = {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32};
    std::size_t turn = 0;
    for (const std::string& recipe : recipes()) {
        const std::vector<std::string> filters = filters_of(recipe);
        for (std::size_t k = 0; k < 4; ++k, ++turn) {
            // Filter and type step at rates without a common factor.
            Way way{kTypes[k], filters[(turn * 3 + turn / 4) % filters.size()], turn % 3 == 2 ? 4 : 3};
            if (turn % 11 == 5) way.channels = 1;
            if (turn % 13 == 7 && recipe.find("kim-2003") == std::string::npos) way.channels = 5;
            list.push_back({recipe, way});
        }
    }
    for (const std::string& recipe : further_recipes()) {
        const std::vector<std::string> filters = filters_of(recipe);
        const bool has_own = recipe.find("filter=") != std::string::npos;
        list.push_back({recipe, {kTypes[turn % 4], has_own ? "" : filters[turn % filters.size()]}});
        ++turn;
    }
    const std::string view = recipes()[0];
    for (const char* const filter : {"bilinear", "bicubic", "antialias"})
        for (const PixelType type : {PixelType::half, PixelType::float32})
            list.push_back(
                {view + (filter == std::string("bicubic") ? "&clamp=1" : ""), {type, filter, 3, true}});
    for (const PixelType type : kTypes) list.push_back({view, {type, "antialias", 4, false, true}});
    for (const char* const recipe :
         {"pano?to=rectilinear&fov=90&yaw=40&pitch=20&size=96x64",
          "pano?to=rectilinear&fov=90&yaw=40&size=64x48&tol=0", "pano?to=cubemap&yaw=20&size=32x192",
          "lens?fov=120&lens=kb4:k1=0.05,k2=0.01", "map?u=width*s^1.3&v=height*t^0.8&wrap=mirror",
          "warp?mesh=grid.json", "morph?features=lines.json&t=0.4",
          "mosaic?circles=2&from=cylindrical&x=0.3&z=-0.2&yaw=70&fov=80&size=64x48",
          "drape?surface=torus&camera=0.4,1.2,2.5&size=64x48&shading=phong&light=1,1,1&specular=0.4"})
        for (const PixelType type : kTypes)
            list.push_back({recipe, {type, "sharp_bicubic", type == PixelType::half ? 4 : 3}});
    for (const PixelType type : {PixelType::half, PixelType::float32})
        list.push_back({view + "&clamp=1", {type, "sharp_bicubic", 3, true}});
    list.push_back({view, {PixelType::uint8, "sharp_bicubic", 4, false, true}});
    for (const char* const output : {"stmap", "bound", "coverage"})
        for (const std::size_t i : {0u, 32u, 41u})
            list.push_back({recipes()[i] + "&output=" + output, {PixelType::float32, "antialias"}});
    for (const std::string& recipe : figure_recipes()) list.push_back({recipe, {PixelType::float32, ""}});
    return list;
}

/// Bumps on a surface and shapes between shapes, as float and double: what VTK's filters hand on.
template <class T>
PictureHash hash_of_surface() {
    std::vector<Deformation> bumps;
    for (std::uint32_t k = 0; k < 12; ++k) {
        Deformation bump;
        const auto part = [&](std::uint32_t i) { return static_cast<double>(noise(i, k) >> 8) * 0x1p-24; };
        bump.center = {part(1), part(2)};
        bump.extent = {0.05 + part(3) / 4, 0.05 + part(4) / 4};
        bump.vector = {part(5) - 0.5, part(6) - 0.5, part(7) - 0.5};
        bump.kernel = k % 2 ? DeformationKernel::gaussian : DeformationKernel::wendland_c2;
        bumps.push_back(bump);
    }
    std::vector<double> u, v;
    for (int i = 0; i <= 50; ++i) u.push_back(i / 50.0);
    for (int i = 0; i <= 33; ++i) v.push_back(i / 33.0);
    std::vector<T> grid(3 * u.size() * v.size());
    deform_grid<T>(bumps, u, v, {}, nullptr, grid.data());
    std::vector<T> other(grid.size()), blended(grid.size()), masked(grid.size());
    std::vector<float> mask(grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) {
        other[i] = static_cast<T>(noise(static_cast<std::uint32_t>(i), 99) >> 8) * static_cast<T>(0x1p-20);
        mask[i] = static_cast<float>(noise(static_cast<std::uint32_t>(i), 98) >> 8) * 0x1p-24f;
    }
    const T* const shapes[] = {grid.data(), other.data()};
    const float* const masks[] = {mask.data(), nullptr};
    const double weights[] = {0.3, 0.7};
    simd::blend(shapes, weights, 2, grid.size(), blended.data());
    simd::blend_masked(shapes, masks, weights, 2, grid.data(), grid.size(), masked.data());
    PictureHasher hasher;
    for (const std::vector<T>* points : {&grid, &blended, &masked})
        hasher.add_numbers(std::as_bytes(std::span(*points)), {sizeof(T), true});
    return hasher.hash();
}

std::map<std::string, std::string> drawn_hashes() {
    std::map<std::string, std::string> lines;
    const auto add = [&](const std::string& name, const auto& hash) {
        try {
            EXPECT_TRUE(lines.emplace(name, hash_digits(hash())).second) << name;
        } catch (const Error& error) {
            ADD_FAILURE() << name << ": " << error.what();
        }
    };
    for (const Case& c : cases())
        add(line_name(c.recipe, c.way), [&] { return hash_of_recipe(c.recipe, c.way); });
    add("deform float", hash_of_surface<float>);
    add("deform double", hash_of_surface<double>);
    return lines;
}

std::map<std::string, std::string> known_hashes() {
    std::ifstream file(ANAMORPH_PICTURE_HASHES);
    std::map<std::string, std::string> lines;
    for (std::string line; std::getline(file, line);)
        if (!line.empty() && line[0] != '#') lines[line.substr(33)] = line.substr(0, 32);
    return lines;
}

TEST(PictureHash, EveryInstructionSetDrawsTheSamePictures) {
    const std::map<std::string, std::string> known = known_hashes();
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        ASSERT_TRUE(simd::use_instruction_set(*set));
        const std::map<std::string, std::string> drawn = drawn_hashes();
        EXPECT_GE(drawn.size(), 200u);
        std::string wrong;
        int differ = 0;
        for (const auto& [name, digits] : drawn) {
            const auto line = known.find(name);
            if (line != known.end() && line->second == digits) continue;
            ++differ;
            wrong += digits + " " + name + "\n";
        }
        EXPECT_EQ(differ, 0) << *set << " of " << drawn.size() << ":\n" << wrong;
        EXPECT_EQ(known.size(), drawn.size());
        if (const char* const to = std::getenv("ANAMORPH_WRITE_HASHES")) {
            std::ofstream file(std::string(to) + "." + *set);
            for (const auto& [name, digits] : drawn) file << digits << " " << name << "\n";
        }
    }
    simd::use_instruction_set("");
}

TEST(PictureHash, IsXxh3OfTheBytes) {
    // As `printf abc | xxhsum -H2` says.
    PictureHasher hasher;
    hasher.add("a");
    hasher.add("bc");
    EXPECT_EQ(hash_digits(hasher.hash()), "06b05ab6733a618578af5f94892f3950");
    EXPECT_EQ(hash_from_digits(hash_digits(hasher.hash()), "hash"), hasher.hash());
    for (const char* const bad : {"", "06b05ab6733a618578af5f94892f395", "06b05ab6733a618578af5f94892f3950a",
                                  "06B05ab6733a618578af5f94892f3950", "06b05ab6733a618578af5f94892f395g"})
        EXPECT_THROW(hash_from_digits(bad, "hash"), Error) << bad;
}

TEST(PictureHash, EveryNanIsTheSame) {
    const auto hash = [](auto bits, bool floating) {
        PictureHasher hasher;
        hasher.add_numbers(std::as_bytes(std::span(&bits, 1)), {sizeof(bits), floating});
        return hasher.hash();
    };
    EXPECT_EQ(hash(std::uint32_t{0x7fc00000}, true), hash(std::uint32_t{0xffc00001}, true));
    EXPECT_EQ(hash(std::uint32_t{0x7fc00000}, true), hash(std::uint32_t{0x7f800001}, true));
    EXPECT_EQ(hash(std::uint16_t{0x7e00}, true), hash(std::uint16_t{0xfc01}, true));
    EXPECT_EQ(hash(std::uint64_t{0x7ff8000000000000}, true), hash(std::uint64_t{0xfff0000000000001}, true));
    EXPECT_NE(hash(std::uint32_t{0x7fc00000}, true), hash(std::uint32_t{0x7f800000}, true));
    EXPECT_NE(hash(std::uint32_t{0x7f800000}, true), hash(std::uint32_t{0xff800000}, true));
    EXPECT_NE(hash(std::uint32_t{0}, true), hash(std::uint32_t{0x80000000}, true));
    EXPECT_NE(hash(std::uint32_t{0x7fc00000}, false), hash(std::uint32_t{0x7fc00001}, false));
}

}  // namespace
}  // namespace anamorph::test_picture_hash
