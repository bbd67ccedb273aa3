// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/panorama_attributes.h"

#include <utility>

namespace anamorph {

Attributes panorama_attributes(const Chart& picture, bool color) {
    Attributes says;
    std::string projection = std::string(name_of(picture.projection())) + " fov=" + shortest(picture.fov());
    if (picture.vertical().fov != 0) projection += " vfov=" + shortest(picture.vertical().fov);
    const int numbers = numbers_of(picture.projection());
    if (numbers > 0) projection += " d=" + shortest(picture.distance().d);
    if (numbers > 1) projection += " e=" + shortest(picture.distance().e);
    if (picture.padding().pixels != 0) projection += " padding=" + picture.padding().text();
    if (picture.lens()) projection += " lens=" + picture.lens()->model().text();
    says.push_back({kPanoramaProjection, projection});
    if (!color) return says;
    const int w = picture.width(), h = picture.height(), whole = w / 2;
    const auto environment = [&](const char* format) {
        says.push_back({"textureformat", format});
        says.push_back({"oiio:updirection", "y"});
    };
    if (picture.projection() == Projection::cubemap && picture.padding().pixels == 0)
        environment("CubeFace Environment");
    // A whole turn, and as much of the poles as whole rows can say.
    const bool is_square = picture.vertical().fov == 0 || (picture.vertical().fov == 180 && w == 2 * h);
    const bool turn =
        picture.projection() == Projection::equirectangular && picture.fov() == 360 && is_square;
    if (turn && w % 2 == 0 && h <= whole && (whole - h) % 2 == 0) {
        says.push_back({"GPano:ProjectionType", "equirectangular"});
        for (const auto& [name, value] : {std::pair{"FullPanoWidthPixels", w},
                                          {"FullPanoHeightPixels", whole},
                                          {"CroppedAreaImageWidthPixels", w},
                                          {"CroppedAreaImageHeightPixels", h},
                                          {"CroppedAreaLeftPixels", 0},
                                          {"CroppedAreaTopPixels", (whole - h) / 2}})
            says.push_back({std::string("GPano:") + name, value});
        if (h == whole) environment("LatLong Environment");
    }
    return says;
}

}  // namespace anamorph
