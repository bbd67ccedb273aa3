// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <QLocale>
#include <QString>

/// The fewest digits that make this number: as it was typed.
inline QString number_text(double number) {
    return QString::number(number, 'g', QLocale::FloatingPointShortest);
}
