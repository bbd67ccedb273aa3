# SPDX-License-Identifier: Apache-2.0
# The libraries that Anamorph::oiio_ops stands on, found the same way by our build and by its users.
find_package(Imath REQUIRED)
find_package(OpenImageIO REQUIRED)
if(OpenImageIO_VERSION VERSION_LESS 2.4)
    message(FATAL_ERROR "OpenImageIO ${OpenImageIO_VERSION} is too old: 2.4 or newer is needed")
endif()
# Debian keeps OpenColorIO's package file outside the folders that CMake looks in.
find_package(OpenColorIO 2 REQUIRED PATH_SUFFIXES share/cmake)

include(${CMAKE_CURRENT_LIST_DIR}/AnamorphLensfun.cmake)

# Debian's packages of both name folders of headers that do not exist; CMake refuses such a path.
foreach(host OpenImageIO::OpenImageIO OpenColorIO::OpenColorIO)
    get_target_property(named ${host} INTERFACE_INCLUDE_DIRECTORIES)
    set(present "")
    foreach(directory IN LISTS named)
        if(EXISTS "${directory}")
            list(APPEND present "${directory}")
        endif()
    endforeach()
    set_target_properties(${host} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${present}")
endforeach()
