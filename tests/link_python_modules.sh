#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/link_python_modules.sh ROOT
# From Debian 13 on the CMake packages of VTK and ParaView look for Python modules by names without the interpreter's, by which they are not
# there: gives those in the root ROOT such names, too.
set -euo pipefail
find "$1/usr/lib" -path '*/dist-packages/*' \( -path '*/vtkmodules/*' -o -path '*/paraview/*' \) -name '*.cpython-*.so' | while read -r module; do
    ln -sf "$(basename "$module")" "${module%%.cpython-*}.so"
done
