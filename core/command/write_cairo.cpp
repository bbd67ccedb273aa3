// SPDX-License-Identifier: Apache-2.0
// PDF and PNG, drawn by cairo.
#include "film_writer.h"
#include "frame_range.h"
#include "write_png.h"
#include "writers.h"

#ifdef ANAMORPH_HAVE_CAIRO
#include <cairo-pdf.h>
#include <cairo.h>

#include <cmath>
#include <cstring>
#include <numbers>
#endif

namespace anamorph::command {
using namespace figure;

#ifdef ANAMORPH_HAVE_CAIRO
namespace {

struct DestroySurface {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;

struct DestroyContext {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Context = std::unique_ptr<cairo_t, DestroyContext>;

void check(cairo_status_t status) {
    if (status != CAIRO_STATUS_SUCCESS) throw Error(std::string("cairo: ") + cairo_status_to_string(status));
}

/// cairo is C: no exception may pass through it.
cairo_status_t write_to(void* file, const unsigned char* data, unsigned int length) {
    try {
        static_cast<OutputFile*>(file)->write({reinterpret_cast<const char*>(data), length});
        return CAIRO_STATUS_SUCCESS;
    } catch (const std::exception&) {
        return CAIRO_STATUS_WRITE_ERROR;
    }
}

void add_path(cairo_t* c, const std::vector<glm::dvec2>& points) {
    for (const glm::dvec2& p : points) cairo_line_to(c, p.x, p.y);
    if (points.size() > 3 && points.front() == points.back()) cairo_close_path(c);
}

void draw_stroke(cairo_t* c, const Stroke& stroke, const Drawing& drawing) {
    const glm::dvec3 rgb = stroke.color / 255.0;
    if (stroke.kind == StrokeKind::dot) {
        cairo_arc(c, stroke.points[0].x, stroke.points[0].y, drawing.line_width, 0, 2 * std::numbers::pi);
        cairo_set_source_rgb(c, rgb.r, rgb.g, rgb.b);
        cairo_fill(c);
        return;
    }
    cairo_set_dash(c, nullptr, 0, 0);
    for (const std::vector<glm::dvec2>& part : stroke.halo) {
        add_path(c, part);
        cairo_set_source_rgb(c, 1, 1, 1);
        cairo_set_line_cap(c, CAIRO_LINE_CAP_BUTT);
        cairo_set_line_width(c, drawing.line_width + 2 * drawing.halo);
        cairo_stroke(c);
    }
    add_path(c, stroke.points);
    if (stroke.kind == StrokeKind::fill) {
        cairo_set_source_rgb(c, rgb.r, rgb.g, rgb.b);
        cairo_fill(c);
        return;
    }
    const double dash = 3 * drawing.line_width;
    cairo_set_dash(c, &dash, stroke.kind == StrokeKind::hidden ? 1 : 0, 0);
    cairo_set_source_rgb(c, rgb.r, rgb.g, rgb.b);
    cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_width(c, drawing.line_width);
    cairo_stroke(c);
}

void draw_on(cairo_surface_t* surface, const Drawing& drawing) {
    const Context context(cairo_create(surface));
    cairo_t* c = context.get();
    cairo_set_source_rgb(c, 1, 1, 1);
    cairo_paint(c);
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    for (const Stroke& stroke : drawing.strokes) draw_stroke(c, stroke, drawing);
    check(cairo_status(c));
}

class PdfWriter : public DrawingWriter {
  public:
    explicit PdfWriter(const std::string& name) : m_file(name) {}
    void add(const Drawing& drawing) override {
        if (!m_surface)
            m_surface.reset(
                cairo_pdf_surface_create_for_stream(write_to, &m_file, drawing.size.x, drawing.size.y));
        check(cairo_surface_status(m_surface.get()));
        draw_on(m_surface.get(), drawing);
        cairo_surface_show_page(m_surface.get());
        check(cairo_surface_status(m_surface.get()));
    }
    void finish() override {
        if (!m_surface) return;
        cairo_surface_finish(m_surface.get());
        check(cairo_surface_status(m_surface.get()));
        m_file.close();
    }

  private:
    OutputFile m_file;  // outlives the surface that writes to it
    Surface m_surface;
};

class PngWriter : public DrawingWriter {
  public:
    PngWriter(std::string name, bool several) : m_name(std::move(name)), m_several(several) {}
    void add(const Drawing& drawing) override {
        const int width = static_cast<int>(std::ceil(drawing.size.x)),
                  height = static_cast<int>(std::ceil(drawing.size.y));
        const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
        check(cairo_surface_status(surface.get()));
        draw_on(surface.get(), drawing);
        cairo_surface_flush(surface.get());
        const unsigned char* const pixels = cairo_image_surface_get_data(surface.get());
        const std::ptrdiff_t stride = cairo_image_surface_get_stride(surface.get());
        std::vector<std::uint8_t> rgb;
        rgb.reserve(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        for (int y = 0; y < height; ++y) add_row(pixels + y * stride, width, rgb);
        OutputFile file(m_several ? numbered_name(m_name, drawing.frame) : m_name);
        write_png(file, width, height, rgb);
        file.close();
    }

  private:
    /// Adds a row of pixels of 32 bits, in the machine's order of bytes.
    static void add_row(const unsigned char* from, int width, std::vector<std::uint8_t>& rgb) {
        for (int x = 0; x < width; ++x, from += 4) {
            std::uint32_t pixel = 0;
            std::memcpy(&pixel, from, sizeof pixel);
            for (const int shift : {16, 8, 0}) rgb.push_back(static_cast<std::uint8_t>(pixel >> shift));
        }
    }

    std::string m_name;
    bool m_several;
};

class PngFramesWriter : public FilmWriter {
  public:
    PngFramesWriter(std::string name, int width, int height)
        : m_name(std::move(name)), m_width(width), m_height(height) {}
    void add(const FilmFrame& frame) override {
        OutputFile file(numbered_name(m_name, frame.number));
        write_png(file, m_width, m_height, frame.pixels);
        file.close();
    }

  private:
    std::string m_name;
    int m_width, m_height;
};

}  // namespace

std::unique_ptr<FilmWriter> png_frames_writer(const std::string& name, int width, int height) {
    return std::make_unique<PngFramesWriter>(name, width, height);
}

std::unique_ptr<DrawingWriter> pdf_writer(const std::string& name) {
    return std::make_unique<PdfWriter>(name);
}

std::unique_ptr<DrawingWriter> png_writer(const std::string& name, bool several) {
    return std::make_unique<PngWriter>(name, several);
}

#else

std::unique_ptr<FilmWriter> png_frames_writer(const std::string&, int, int) {
    throw Error("this anamorph-figure was built without cairo, which writes PNG");
}

std::unique_ptr<DrawingWriter> pdf_writer(const std::string&) {
    throw Error("this anamorph-figure was built without cairo, which draws PDF");
}

std::unique_ptr<DrawingWriter> png_writer(const std::string&, bool) {
    throw Error("this anamorph-figure was built without cairo, which draws PNG");
}

#endif

}  // namespace anamorph::command
