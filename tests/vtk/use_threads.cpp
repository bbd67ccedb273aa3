// SPDX-License-Identifier: Apache-2.0
// Compiled as C++17: VTK 9.1's vtkSMPTools.h is no C++20.
#include <vtkSMPTools.h>

#include <cstring>

bool use_threads(const char* backend, int threads);

bool use_threads(const char* backend, int threads) {
    if (backend && std::strcmp(vtkSMPTools::GetBackend(), backend) != 0 && !vtkSMPTools::SetBackend(backend))
        return false;
    vtkSMPTools::Initialize(threads);
    return true;
}
