// SPDX-License-Identifier: Apache-2.0
// A slider: a line with a knob and a name, in a renderer.
#pragma once

#include <vtkTextActor.h>

#include <memory>
#include <string>

#include "pane.h"

namespace anamorph_editor {

class Slider {
  public:
    /// `name`: the recipe's key. Values outside of the range widen it.
    Slider(vtkRenderer* renderer, Damage& damage, const std::string& name, double least, double most,
           double value);

    const std::string& name() const { return m_name; }
    double value() const { return m_value; }
    void set(double value);
    /// Takes its place, in pixels of the renderer.
    void place(double left, double right, double height);
    bool has(const Point<double>& at) const;
    /// The value at a place, within its range.
    double value_at(double x) const;

  private:
    void show();

    std::string m_name;
    double m_least, m_most, m_value;
    double m_left = 0, m_right = 1, m_height = 0;
    Overlay m_line, m_knob;
    vtkNew<vtkTextActor> m_text;
};

}  // namespace anamorph_editor
