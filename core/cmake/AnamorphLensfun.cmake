# SPDX-License-Identifier: Apache-2.0
# Lensfun's database of lenses, where it is there: of versions 0.3, whose classes those of 0.3.95 and later are not.
find_path(LENSFUN_INCLUDE_DIR lensfun/lensfun.h)
find_library(LENSFUN_LIBRARY lensfun)
mark_as_advanced(LENSFUN_INCLUDE_DIR LENSFUN_LIBRARY)
if(LENSFUN_INCLUDE_DIR AND LENSFUN_LIBRARY AND NOT TARGET Lensfun::lensfun)
    set(lensfun_version 0)
    foreach(part MAJOR MINOR MICRO)
        file(STRINGS ${LENSFUN_INCLUDE_DIR}/lensfun/lensfun.h line REGEX "^#define LF_VERSION_${part}[ \t]+[0-9]+")
        string(REGEX REPLACE "^.*[ \t]" "" number "${line}")
        set(lensfun_version ${lensfun_version}.${number})
    endforeach()
    if(lensfun_version VERSION_GREATER_EQUAL 0.0.3.0 AND lensfun_version VERSION_LESS 0.0.3.95)
        add_library(Lensfun::lensfun UNKNOWN IMPORTED)
        set_target_properties(Lensfun::lensfun PROPERTIES IMPORTED_LOCATION ${LENSFUN_LIBRARY}
                                                          INTERFACE_INCLUDE_DIRECTORIES ${LENSFUN_INCLUDE_DIR})
    endif()
endif()
