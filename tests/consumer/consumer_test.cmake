# SPDX-License-Identifier: Apache-2.0
# Installs a finished build into an empty folder, builds the consumer project against that and runs it.
# Needs: SOURCE_DIR, BUILD_DIR, WORK_DIR (emptied), CXX_COMPILER, CTEST_COMMAND.

function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(status)
        list(JOIN ARGV " " command)
        message(FATAL_ERROR "${command}\nfailed (${status}):\n${text}")
    endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${CTEST_COMMAND} --test-dir ${WORK_DIR}/build --output-on-failure --no-tests=error)

# A stock host loads the installed plugin.
file(GLOB_RECURSE plugin ${WORK_DIR}/prefix/anamorph.imageio.so)
get_filename_component(plugin_dir "${plugin}" DIRECTORY)
run(oiiotool --pattern fill:color=0.25,0.5,0.75 64x32 3 -o ${WORK_DIR}/panorama.exr)
run(${CMAKE_COMMAND} -E env OIIO_LIBRARY_PATH=${plugin_dir}
    oiiotool "${WORK_DIR}/panorama.exr.pano?to=rectilinear&size=16x16" -o ${WORK_DIR}/view.exr)
if(NOT EXISTS ${WORK_DIR}/view.exr)
    message(FATAL_ERROR "oiiotool wrote no view")
endif()
