# SPDX-License-Identifier: Apache-2.0
# The core configures, builds and passes its tests with no host library to be found, and reads no host header.
# Needs: SOURCE_DIR, BINARY_DIR (of the build with hosts), WORK_DIR (emptied), CXX_COMPILER, WERROR, CTEST_COMMAND.

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

# Programs that are those of the build with hosts, byte for byte, are tested there.
set(same TRUE)
foreach(program tests/core/anamorph_core_tests core/command/anamorph core/command/anamorph-figure
                core/command/anamorph-machine)
    if(NOT EXISTS ${WORK_DIR}/${program})
        message(FATAL_ERROR "${WORK_DIR}/${program} was not built")
    endif()
    execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${WORK_DIR}/${program} ${BINARY_DIR}/${program}
                    RESULT_VARIABLE differs OUTPUT_QUIET ERROR_QUIET)
    if(differs)
        message(STATUS "${program} differs from that of the build with hosts")
        set(same FALSE)
    endif()
endforeach()
if(same)
    message(STATUS "The programs are those of the build with hosts.")
    return()
endif()
run(${CTEST_COMMAND} --test-dir ${WORK_DIR} --output-on-failure --no-tests=error --parallel 2)
message(STATUS "${text}")
