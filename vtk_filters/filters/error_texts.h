// SPDX-License-Identifier: Apache-2.0
// The errors of VTK's own classes, as a part of ours instead of lines in a log.
#pragma once

#include <string>

#include "vtkObject.h"
#include "vtkSmartPointer.h"

namespace anamorph_vtk {

/// While it lives, errors of an object are not printed.
class ErrorTexts {
  public:
    explicit ErrorTexts(vtkObject* object);
    ~ErrorTexts();
    ErrorTexts(const ErrorTexts&) = delete;
    ErrorTexts& operator=(const ErrorTexts&) = delete;

    bool any() const;
    /// The first one, ": " before it and without the place in a source file; empty where there is none.
    std::string text() const;

  private:
    class Listener;

    vtkSmartPointer<vtkObject> m_object;
    vtkSmartPointer<Listener> m_listener;
    unsigned long m_tag;
};

}  // namespace anamorph_vtk
