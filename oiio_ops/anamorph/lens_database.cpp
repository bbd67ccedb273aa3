// SPDX-License-Identifier: Apache-2.0
#include "anamorph/lens_database.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

#include "anamorph/lens_search.h"
#include "anamorph/operation/rows.h"

#ifdef ANAMORPH_LENSFUN
#include <lensfun/lensfun.h>
#endif

namespace anamorph {
namespace {

/// Adds what the metadata say and the text does not.
void add_metadata(LensName& name, const OIIO::ImageSpec& spec) {
    if (name.camera.empty()) {
        name.maker = spec.get_string_attribute("Make");
        name.camera = spec.get_string_attribute("Model");
    }
    if (name.lens.empty()) name.lens = spec.get_string_attribute("Exif:LensModel");
    const double focal = spec.get_float_attribute("Exif:FocalLength");
    if (!name.focal && focal > 0 && std::isfinite(focal)) name.focal = focal;
}

#ifdef ANAMORPH_LENSFUN

/// The database, which is loaded once. Searches write into it, so they are one at a time; and loading sets the process's locale and
/// puts it back.
class Database {
  public:
    static std::mutex& mutex() {
        static auto& mutex = *new std::mutex;
        return mutex;
    }
    /// With the mutex held.
    static const lfDatabase& get(const std::string& parameter, const std::string& text) {
        static lfDatabase* const loaded = [] {
            lfDatabase* database = new lfDatabase;
            return database->Load() == LF_NO_ERROR ? database : nullptr;
        }();
        if (!loaded)
            throw Error(parameter, text,
                        "Lensfun's database is not there: must be installed (liblensfun-data-v1)");
        return *loaded;
    }
};

/// The lens of the installed database that is asked for.
FoundLens find_installed(const std::string& parameter, const LensName& asked, const Size& size) {
    const std::scoped_lock lock(Database::mutex());
    return find_lens(Database::get(parameter, asked.text), parameter, asked, size);
}

#else

FoundLens find_installed(const std::string& parameter, const LensName& asked, const Size&) {
    throw Error(parameter, asked.text,
                "Anamorph was built without Lensfun: must be a model with its numbers");
}

#endif

/// Is a key given that not all operations have?
bool is_given(const ParameterValues& values, const char* name) {
    return values.knows(name) && values.given(name);
}

/// The size of the picture that is seen through a lens: the source's, or for that of a picture what is asked for.
Size size_through(const Operation& operation, const ParameterValues& values, const std::string& parameter,
                  const Size& source) {
    const bool takes_off = operation.name == "lens" && values.text("mode") == "undistort";
    if (parameter == "srclens" || takes_off) return source;
    if (operation.name == "lens")
        return values.text("size") == "all" ? source : rows::size_of(values, source);
    const Size asked = values.given("size") ? values.extent("size") : Size{0, -1};
    if (asked.height < 0)
        throw Error(parameter, printable(values.text(parameter)),
                    "must be given together with the picture's width and height, as in size=3000x2000");
    return asked;
}

}  // namespace

bool has_lens_database() {
#ifdef ANAMORPH_LENSFUN
    return true;
#else
    return false;
#endif
}

Attributes find_lenses(const Operation& operation, ParameterValues& values,
                       const std::vector<OIIO::ImageSpec>& specs, std::vector<SourceImage>& sources) {
    Attributes says;
    for (const std::string parameter : {"srclens", "lens"}) {
        if (!is_given(values, parameter.c_str()) || sources.empty()) continue;
        const std::string text = values.text(parameter);
        if (!is_of_lens_database(text)) continue;
        LensName name = parse_lens_name(parameter, text);
        const bool of_source = parameter == "srclens" || operation.name == "lens";
        if (of_source) add_metadata(name, specs[0]);
        SourceFacts& facts = sources[0].facts;
        const Size size = size_through(operation, values, parameter, {facts.width, facts.height});
        const FoundLens found = find_installed(parameter, name, size);
        values.set(parameter, found.model.text());
        says.push_back({"anamorph:" + parameter, found.name});
        if (parameter != "srclens" || facts.projection || !found.projection) continue;
        const double width = size.width / found.focal_length,
                     fov = fov_of_plane_width(*found.projection, width);
        // A circle that does not fill the picture: fields of view are those of its edges.
        if (!(plane_width(*found.projection, fov) >= width * (1 - 1e-9))) {
            if (is_given(values, "from") && is_given(values, "srcfov")) continue;
            throw Error(
                parameter, name.text,
                found.name + " does not fill the width of its picture: from and srcfov must be given");
        }
        facts.projection = found.projection;
        facts.said_by = "Lensfun";
        facts.fov = fov;
    }
    return says;
}

}  // namespace anamorph
