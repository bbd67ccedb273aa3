// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/photo_sphere.h"

#include <istream>
#include <pugixml.hpp>
#include <set>

namespace anamorph {
namespace {

// Adobe's XMP specification, part 3: the beginning of its segment, with a zero byte behind it.
constexpr std::string_view kXmp("http://ns.adobe.com/xap/1.0/\0", 29);
constexpr std::string_view kPanorama = "http://ns.google.com/photos/1.0/panorama/";
/// Files have some tens of segments before the picture; those of broken ones may be without end.
constexpr int kMostSegments = 4096;

constexpr int kStart = 0xd8, kApplication1 = 0xe1, kScan = 0xda, kEnd = 0xd9;
/// Has a marker no segment?
bool stands_alone(int marker) {
    return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8);
}

/// The next marker, behind any fill bytes; negative where there is none.
int next_marker(std::istream& file) {
    if (file.get() != 0xff) return -1;
    int marker = file.get();
    while (marker == 0xff) marker = file.get();
    return file ? marker : -1;
}

/// Takes the elements and attributes of the namespace, whose prefixes are those that any element gives to it.
class Collector final : public pugi::xml_tree_walker {
  public:
    Collector(const std::set<std::string>& prefixes, PhotoSphere& values)
        : m_prefixes(prefixes), m_values(values) {}
    bool for_each(pugi::xml_node& node) override {
        add(node.name(), node.child_value());
        for (const pugi::xml_attribute& attribute : node.attributes())
            add(attribute.name(), attribute.value());
        return true;
    }

  private:
    void add(std::string_view name, const char* value) {
        const std::size_t colon = name.find(':');
        if (colon == std::string_view::npos || !m_prefixes.contains(std::string(name.substr(0, colon))))
            return;
        m_values.emplace(name.substr(colon + 1), value);
    }
    const std::set<std::string>& m_prefixes;
    PhotoSphere& m_values;
};

class Prefixes final : public pugi::xml_tree_walker {
  public:
    bool for_each(pugi::xml_node& node) override {
        constexpr std::string_view kDefines = "xmlns:";
        for (const pugi::xml_attribute& attribute : node.attributes())
            if (const std::string_view name = attribute.name();
                name.starts_with(kDefines) && attribute.value() == kPanorama)
                found.emplace(name.substr(kDefines.size()));
        return true;
    }
    std::set<std::string> found;
};

}  // namespace

std::string xmp_of_jpeg(std::istream& file) {
    if (next_marker(file) != kStart) return "";
    for (int i = 0; i < kMostSegments; ++i) {
        const int marker = next_marker(file);
        if (marker < 0 || marker == kScan || marker == kEnd) return "";
        if (stands_alone(marker)) continue;
        // Big endian; the two bytes count themselves.
        const int high = file.get(), low = file.get(), length = high * 256 + low - 2;
        if (!file || length < 0) return "";
        if (marker != kApplication1) {
            file.ignore(length);
            continue;
        }
        std::string segment(static_cast<std::size_t>(length), '\0');
        if (!file.read(segment.data(), length)) return "";
        if (segment.starts_with(kXmp)) return segment.substr(kXmp.size());
    }
    return "";
}

PhotoSphere photo_sphere_of(std::string_view xmp) {
    pugi::xml_document document;
    PhotoSphere values;
    if (!document.load_buffer(xmp.data(), xmp.size())) return values;
    Prefixes prefixes;
    document.traverse(prefixes);
    Collector collector(prefixes.found, values);
    document.traverse(collector);
    return values;
}

}  // namespace anamorph
