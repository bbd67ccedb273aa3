# SPDX-License-Identifier: Apache-2.0
# A user of Anamorph::core compiles the numbers of its headers as they are proven: options that prevent that come with the
# target where no header sees that they are missing, and are an error of the headers where one does.
if(NOT CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    return()
endif()

# On a processor with fused multiply-adds, compiled for it, none is used.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    add_executable(no_contraction no_contraction.cpp)
    target_link_libraries(no_contraction PRIVATE Anamorph::core)
    target_compile_options(no_contraction PRIVATE -O3 -mfma)
    add_test(NAME no_contraction COMMAND no_contraction)
endif()

# All of it as a user's compiler gets it.
set(options -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND options -fno-tree-slp-vectorize)
endif()
list(JOIN options "|" options)
add_test(NAME options COMMAND ${CMAKE_COMMAND} -DCOMMANDS=${CMAKE_CURRENT_BINARY_DIR}/compile_commands.json
                              -DSOURCE=core_consumer.cpp "-DOPTIONS=${options}"
                              -P ${CMAKE_CURRENT_SOURCE_DIR}/expect_options.cmake)

# compiles(RESULT OUTPUT OPTIONS HEADER...) tells whether headers compile with options, up to the first error.
function(compiles result output options)
    set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
    list(TRANSFORM ARGN REPLACE "(.+)" "#include <anamorph/\\1.h>\n")
    list(JOIN ARGN "" source)
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/arithmetic.cpp "${source}")
    try_compile(done ${CMAKE_CURRENT_BINARY_DIR}/arithmetic ${CMAKE_CURRENT_BINARY_DIR}/arithmetic.cpp
                LINK_LIBRARIES Anamorph::core COMPILE_DEFINITIONS -Wfatal-errors ${options} OUTPUT_VARIABLE said)
    set(${result} ${done} PARENT_SCOPE)
    set(${output} "${said}" PARENT_SCOPE)
    unset(done CACHE)
endfunction()

set(numbers number/interval number/jet number/near_bound number/number number/rounded number/sinc_series)
compiles(plain output "" ${numbers})
if(NOT plain)
    message(FATAL_ERROR "the headers of numbers do not compile:\n${output}")
endif()
function(expect_refused header option)
    compiles(fast output ${option} ${header})
    if(fast OR NOT output MATCHES "Anamorph's bounds")
        message(FATAL_ERROR "anamorph/${header}.h with ${option} is not refused:\n${output}")
    endif()
endfunction()
foreach(header IN LISTS numbers)
    expect_refused(${header} -ffast-math)
endforeach()
expect_refused(geometry/point -ffinite-math-only)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Clang does not say that it has these.
    expect_refused(number/interval -funsafe-math-optimizations)
    expect_refused(number/interval -freciprocal-math)
endif()
