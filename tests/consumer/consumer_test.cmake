# SPDX-License-Identifier: Apache-2.0
# Installs a finished build, builds the consumer project against that and runs it.
# Needs: SOURCE_DIR, BUILD_DIR, WORK_DIR (emptied), CXX_COMPILER, CTEST_COMMAND.
include(${CMAKE_CURRENT_LIST_DIR}/install_and_test.cmake)
install_and_test()

# Who asks for components gets these alone: no host is looked for, and what is not there is named.
function(ask components done output)
    file(WRITE ${WORK_DIR}/components/CMakeLists.txt
         "cmake_minimum_required(VERSION 3.25)\nproject(Components LANGUAGES CXX)\n"
         "find_package(Anamorph REQUIRED COMPONENTS ${components})\n"
         "if(TARGET OpenImageIO::OpenImageIO OR NOT TARGET Anamorph::core)\nmessage(FATAL_ERROR \"other targets\")\nendif()\n")
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK_DIR}/components -B ${WORK_DIR}/components/build
                            -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
                    RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
    set(${done} ${result} PARENT_SCOPE)
    set(${output} "${said}" PARENT_SCOPE)
endfunction()
ask("core figure" failed said)
if(failed)
    message(FATAL_ERROR "components core and figure: ${said}")
endif()
ask("core wibble" failed said)
if(NOT failed OR NOT said MATCHES "there is no component wibble")
    message(FATAL_ERROR "a component that is not there: ${said}")
endif()

# The project that docs/cpp.md shows, with its program.
file(READ ${SOURCE_DIR}/../../docs/cpp.md page)
if(NOT page MATCHES "```cmake\n([^`]*)```")
    message(FATAL_ERROR "docs/cpp.md: no project")
endif()
file(WRITE ${WORK_DIR}/mine/CMakeLists.txt "${CMAKE_MATCH_1}")
file(COPY_FILE ${SOURCE_DIR}/../../examples/cpp/panorama.cpp ${WORK_DIR}/mine/mine.cpp)
run(${CMAKE_COMMAND} -S ${WORK_DIR}/mine -B ${WORK_DIR}/mine/build -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/mine/build)
run(${WORK_DIR}/mine/build/mine)

# The installed module is found by the folder that docs/install.md names.
if(EXISTS ${WORK_DIR}/prefix/lib/python3/dist-packages/anamorph)
    run(${CMAKE_COMMAND} -E env PYTHONPATH=${WORK_DIR}/prefix/lib/python3/dist-packages /usr/bin/python3 -c
        "import anamorph; assert anamorph.__file__.startswith('${WORK_DIR}')")
endif()

# A stock host loads the installed plugin.
file(GLOB_RECURSE plugin ${WORK_DIR}/prefix/anamorph_recipes.imageio.so)
get_filename_component(plugin_dir "${plugin}" DIRECTORY)
run(oiiotool --pattern fill:color=0.25,0.5,0.75 64x32 3 -o ${WORK_DIR}/panorama.exr)
run(${CMAKE_COMMAND} -E env OIIO_LIBRARY_PATH=${plugin_dir}
    oiiotool "${WORK_DIR}/panorama.exr.pano?to=rectilinear&size=16x16" -o ${WORK_DIR}/view.exr)
if(NOT EXISTS ${WORK_DIR}/view.exr)
    message(FATAL_ERROR "oiiotool wrote no view")
endif()
