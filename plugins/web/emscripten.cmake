# SPDX-License-Identifier: Apache-2.0
# What the preset web includes when it is configured for WebAssembly (CMAKE_PROJECT_TOP_LEVEL_INCLUDES): the libraries that the core needs,
# of which it needs the headers that Debian has for this machine. They are linked beside each other in a folder, since /usr/include has
# this machine's C library too.
set(headers ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
foreach(name boost gemmi glm hwy nlohmann pugiconfig.hpp pugixml.hpp xxh3.h xxhash.h)
    if(NOT EXISTS /usr/include/${name})
        message(FATAL_ERROR "/usr/include/${name} is missing: tests/install_packages.sh build web")
    endif()
    file(CREATE_LINK /usr/include/${name} ${headers}/${name} SYMBOLIC)
endforeach()
set(GEMMI_INCLUDE_DIR ${headers} CACHE PATH "")
set(XXHASH_INCLUDE_DIR ${headers} CACHE PATH "")

macro(anamorph_web_package method name)
    if("${name}" MATCHES "^(glm|hwy|nlohmann_json|pugixml)$")
        if(NOT TARGET ${name}::${name})
            add_library(${name}::${name} INTERFACE IMPORTED GLOBAL)
            target_include_directories(${name}::${name} INTERFACE ${headers})
        endif()
        set(${name}_FOUND TRUE)
    endif()
endmacro()
cmake_language(SET_DEPENDENCY_PROVIDER anamorph_web_package SUPPORTED_METHODS FIND_PACKAGE)

# Exceptions are WebAssembly's own: those that go through JavaScript cost every call.
add_compile_options(-fwasm-exceptions -msimd128)
add_link_options(-fwasm-exceptions)

# The page's pictures are red, green and blue of 8 bits, so loops over other texels are left out (image/texel_types.h).
if(NOT ANAMORPH_TESTS)
    add_compile_definitions(ANAMORPH_SMALL)
endif()

# plugins/web/libm.cpp has these functions in place of musl's.
set(ANAMORPH_WEB_LIBM "")
foreach(function sin cos tan asin acos atan atan2)
    list(APPEND ANAMORPH_WEB_LIBM -Wl,--wrap=${function})
endforeach()
