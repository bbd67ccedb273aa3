// SPDX-License-Identifier: Apache-2.0
#include "slider.h"

#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

#include "anamorph/parameter/parameter.h"

namespace anamorph_editor {
namespace {

constexpr double kReach = 12, kTextAbove = 8;

}  // namespace

Slider::Slider(vtkRenderer* renderer, Damage& damage, const std::string& name, double least, double most,
               double value)
    : m_name(name),
      m_least(std::min(least, value)),
      m_most(std::max(most, value)),
      m_value(value),
      m_line(renderer, damage, {0.7, 0.7, 0.7}, 3),
      m_knob(renderer, damage, {1, 0.85, 0.2}, 13) {
    m_text->GetTextProperty()->SetFontSize(13);
    renderer->AddActor2D(m_text);
}

void Slider::set(double value) {
    m_value = value;
    m_least = std::min(m_least, value);
    m_most = std::max(m_most, value);
    this->show();
}

void Slider::place(double left, double right, double height) {
    m_left = left;
    m_right = right;
    m_height = height;
    this->show();
}

bool Slider::has(const Point<double>& at) const {
    return at.x >= m_left - kReach && at.x <= m_right + kReach && std::fabs(at.y - m_height) <= kReach;
}

double Slider::value_at(double x) const {
    const double part = std::clamp((x - m_left) / (m_right - m_left), 0.0, 1.0);
    return m_least + part * (m_most - m_least);
}

void Slider::show() {
    const double part = m_most > m_least ? (m_value - m_least) / (m_most - m_least) : 0;
    m_line.set_lines({{{m_left, m_height}, {m_right, m_height}}});
    m_knob.set_points({{m_left + part * (m_right - m_left), m_height}});
    m_text->SetPosition(m_left, m_height + kTextAbove);
    m_text->SetInput((m_name + " " + anamorph::shortest(static_cast<float>(m_value))).c_str());
}

}  // namespace anamorph_editor
