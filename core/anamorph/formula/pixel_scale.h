// SPDX-License-Identifier: Apache-2.0
// Pixels of one picture as those of the same picture at another size.
#pragma once

#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"
#include "anamorph/number/number.h"

namespace anamorph {

/// The point of a picture of size `to` where one of size `from` has (x, y).
class PixelScale {
  public:
    PixelScale(const Size& from, const Size& to)
        : m_is_one(from == to),
          m_x(static_cast<DoubleDouble>(to.width) / from.width),
          m_y(static_cast<DoubleDouble>(to.height) / from.height) {}

    template <class T>
    Point<T> operator()(const T& x, const T& y) const {
        if (m_is_one) return {x, y};
        return {T(x * m_x.as<T>()), T(y * m_y.as<T>())};
    }

  private:
    bool m_is_one;
    Constant m_x, m_y;
};

}  // namespace anamorph
