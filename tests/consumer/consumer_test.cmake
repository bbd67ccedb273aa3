# SPDX-License-Identifier: Apache-2.0
# Installs a finished build, builds the consumer project against that and runs it.
# Needs: SOURCE_DIR, BUILD_DIR, WORK_DIR (emptied), CXX_COMPILER, CTEST_COMMAND.
include(${CMAKE_CURRENT_LIST_DIR}/install_and_test.cmake)
install_and_test()

# A stock host loads the installed plugin.
file(GLOB_RECURSE plugin ${WORK_DIR}/prefix/anamorph_recipes.imageio.so)
get_filename_component(plugin_dir "${plugin}" DIRECTORY)
run(oiiotool --pattern fill:color=0.25,0.5,0.75 64x32 3 -o ${WORK_DIR}/panorama.exr)
run(${CMAKE_COMMAND} -E env OIIO_LIBRARY_PATH=${plugin_dir}
    oiiotool "${WORK_DIR}/panorama.exr.pano?to=rectilinear&size=16x16" -o ${WORK_DIR}/view.exr)
if(NOT EXISTS ${WORK_DIR}/view.exr)
    message(FATAL_ERROR "oiiotool wrote no view")
endif()
