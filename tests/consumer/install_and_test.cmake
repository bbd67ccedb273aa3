# SPDX-License-Identifier: Apache-2.0
# install_and_test(CACHE_ENTRY...) installs the finished build BUILD_DIR into an empty folder, moves that to
# WORK_DIR/prefix, and builds and tests the project SOURCE_DIR against it.
# Needs: SOURCE_DIR, BUILD_DIR, WORK_DIR (emptied), CXX_COMPILER, CTEST_COMMAND.
include(${CMAKE_CURRENT_LIST_DIR}/../run_command.cmake)

function(install_and_test)
    file(REMOVE_RECURSE ${WORK_DIR})
    run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/first)
    file(RENAME ${WORK_DIR}/first ${WORK_DIR}/prefix)
    run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -DCMAKE_BUILD_TYPE=Release
        -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix ${ARGV})
    run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
    run(${CTEST_COMMAND} --test-dir ${WORK_DIR}/build --output-on-failure --no-tests=error)
endfunction()
