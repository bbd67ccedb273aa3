# SPDX-License-Identifier: Apache-2.0
# The core configures, builds and passes its tests with no host library to be found, and reads no host header.
# Needs: SOURCE_DIR, WORK_DIR (emptied), CXX_COMPILER, WERROR, CTEST_COMMAND.

include(${CMAKE_CURRENT_LIST_DIR}/run_command.cmake)

set(hidden "")
foreach(package OpenImageIO OpenColorIO Imath OpenEXR VTK ParaView)
    list(APPEND hidden -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
list(APPEND hidden -DOPENCV_INCLUDE_DIR=OFF)  # the benchmark looks for it without a package

file(REMOVE_RECURSE ${WORK_DIR})
# Makefiles, because they keep the compiler's list of every header read (*.d).
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR} -G "Unix Makefiles" -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DANAMORPH_WERROR=${WERROR} -DANAMORPH_TOOLKIT=NONE -DANAMORPH_OIIO=OFF ${hidden})
run(${CMAKE_COMMAND} --build ${WORK_DIR} --parallel 2)

file(GLOB_RECURSE lists ${WORK_DIR}/*.d)
if(NOT lists)
    message(FATAL_ERROR "no lists of headers under ${WORK_DIR}")
endif()
foreach(list ${lists})
    file(STRINGS ${list} host_headers REGEX "/(OpenImageIO|OpenColorIO|Imath|OpenEXR|vtk[^/]*|paraview[^/]*|opencv[^/]*)/")
    if(host_headers)
        message(FATAL_ERROR "${list}: reads a host header: ${host_headers}")
    endif()
endforeach()

run(${CTEST_COMMAND} --test-dir ${WORK_DIR} --output-on-failure --no-tests=error --parallel 2)
message(STATUS "${text}")
