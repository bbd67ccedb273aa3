// SPDX-License-Identifier: Apache-2.0
// Features: lines that correspond to each other in two or more pictures (key shapes), and the pull map that
// they make (Beier and Neely 1992; Kim 2003, eq. 5.9 to 5.11).
//
// Frames. Pixels of each key shape's own picture, x right, y down, the centre of pixel (i, j) at (i + 0.5,
// j + 0.5). A picture of another size than the features were drawn for (Features::frame) is taken to show the
// same, scaled. The map works in the target's pixels: every shape's lines are scaled onto the target, and
// what comes out is scaled back to that shape's picture. With the shapes' weights at one shape, the map to
// that shape is hence exactly the scaling (the identity where the sizes agree).
#pragma once

#include <string>
#include <vector>

#include "anamorph/map/chart.h"

namespace anamorph {

/// From p to q, in pixels.
struct Line {
    Point<double> p, q;
};

/// What corresponds in `shapes` pictures.
class Features {
  public:
    struct Frame {
        double width = 0, height = 0;
    };

    /// Throws Error when there are fewer than two shapes.
    explicit Features(int shapes = 2);

    int shapes() const { return m_shapes; }
    /// The number of lines.
    std::size_t size() const { return m_weights.size(); }
    const Line& line(std::size_t i, int shape) const {
        return m_lines[i * static_cast<std::size_t>(m_shapes) + static_cast<std::size_t>(shape)];
    }
    /// A factor of the line's weight (eq. 5.11); 1 unless said.
    double weight(std::size_t i) const { return m_weights[i]; }
    /// What messages call the line: its name or "line 7" (the first is 1).
    std::string name(std::size_t i) const;

    /// `line`: one a shape. Throws Error, naming the line, when one has no length (in the pixels that it is
    /// given in) or is not finite, and when the weight is not finite or below 0.
    void add_line(const std::vector<Line>& line, double weight = 1, const std::string& name = {});
    /// A chain of lines from vertex to vertex; as many vertices in every shape.
    void add_polyline(const std::vector<std::vector<Point<double>>>& vertices, double weight = 1,
                      const std::string& name = {});
    /// Cubic Bezier segments, 3 n + 1 control points in every shape. Each segment becomes a chain of lines
    /// between points at equal steps of its parameter, as many as keep every shape's chain within
    /// kCurveDeviation of its curve, at most kMostCurveLines.
    void add_curve(const std::vector<std::vector<Point<double>>>& control_points, double weight = 1,
                   const std::string& name = {});
    static constexpr double kCurveDeviation = 0.25;  ///< pixels
    static constexpr int kMostCurveLines = 64;

    /// Holds the picture's border: its four edges become lines of this weight in every shape. 0: not.
    void pin_border(double weight);
    double border_weight() const { return m_border; }

    /// The size of the picture for which a shape's lines are given; {0, 0}: whatever size the picture has.
    Frame frame(int shape) const { return m_frames[static_cast<std::size_t>(shape)]; }
    void set_frame(int shape, const Frame& frame);

  private:
    int m_shapes;
    std::vector<Line> m_lines;  ///< line by line, shape by shape
    std::vector<double> m_weights;
    std::vector<std::string> m_names;
    std::vector<Frame> m_frames;
    double m_border = 0;
};

}  // namespace anamorph
