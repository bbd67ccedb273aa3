# SPDX-License-Identifier: Apache-2.0
# Installs a finished build into an empty folder, moves that, builds a user of the VTK modules against it and
# runs it, and imports the installed Python package.
# Needs: SOURCE_DIR, BUILD_DIR, WORK_DIR (emptied), CXX_COMPILER, CTEST_COMMAND, TOOLKIT_DIR (cache entry),
# PYTHON, PYTHON_DIR, TOOLKIT_PYTHON. Also builds the example of EXAMPLES_DIR, if given.

function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(status)
        list(JOIN ARGV " " command)
        message(FATAL_ERROR "${command}\nfailed (${status}):\n${text}")
    endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/first)
file(RENAME ${WORK_DIR}/first ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER=${CXX_COMPILER} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -D${TOOLKIT_DIR})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${CTEST_COMMAND} --test-dir ${WORK_DIR}/build --output-on-failure --no-tests=error)
if(EXAMPLES_DIR)
    run(${CMAKE_COMMAND} -S ${EXAMPLES_DIR} -B ${WORK_DIR}/examples -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
        -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -D${TOOLKIT_DIR})
    run(${CMAKE_COMMAND} --build ${WORK_DIR}/examples)
endif()
run(${CMAKE_COMMAND} -E env PYTHONPATH=${WORK_DIR}/prefix/${PYTHON_DIR}:${TOOLKIT_PYTHON} PYTHONDONTWRITEBYTECODE=1
    ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/test_package.py ${WORK_DIR}/prefix)
