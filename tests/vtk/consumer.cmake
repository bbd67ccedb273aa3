# SPDX-License-Identifier: Apache-2.0
# Installs a finished build, builds a user of the VTK modules against it and runs it, and imports the installed
# Python package.
# Needs: SOURCE_DIR, BUILD_DIR, WORK_DIR (emptied), CXX_COMPILER, CTEST_COMMAND, TOOLKIT_DIR (cache entry),
# PYTHON, PYTHON_DIR, TOOLKIT_PYTHON. Also builds the example of EXAMPLES_DIR, if given.
include(${CMAKE_CURRENT_LIST_DIR}/../consumer/install_and_test.cmake)
install_and_test(-D${TOOLKIT_DIR})
if(EXAMPLES_DIR)
    run(${CMAKE_COMMAND} -S ${EXAMPLES_DIR} -B ${WORK_DIR}/examples -DCMAKE_CXX_COMPILER=${CXX_COMPILER}
        -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix -D${TOOLKIT_DIR})
    run(${CMAKE_COMMAND} --build ${WORK_DIR}/examples)
endif()
run(${CMAKE_COMMAND} -E env PYTHONPATH=${WORK_DIR}/prefix/${PYTHON_DIR}:${TOOLKIT_PYTHON} PYTHONDONTWRITEBYTECODE=1
    ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/test_package.py ${WORK_DIR}/prefix)
