# SPDX-License-Identifier: Apache-2.0
# What is installed of the core's headers is whole and no more than needed: anamorph.h gathers the public ones, one a topic, they
# and the details include nothing else of the core, and every detail is included.
# Needs: CORE_DIR; PUBLIC and DETAILS, lists of paths with | between them.
cmake_minimum_required(VERSION 3.25)

foreach(list PUBLIC DETAILS)
    string(REPLACE "|" ";" ${list} "${${list}}")
    list(REMOVE_ITEM ${list} "") # of libraries without
    list(TRANSFORM ${list} REPLACE "^${CORE_DIR}/" "")
endforeach()
set(all_included "")
foreach(header IN LISTS PUBLIC DETAILS)
    file(STRINGS ${CORE_DIR}/${header} includes REGEX "^ *# *include \"anamorph/")
    list(TRANSFORM includes REPLACE "^ *# *include \"([^\"]*)\".*" "\\1")
    list(APPEND all_included ${includes})
    # anamorph.h gathers the public ones, itself aside; the others may include details as well.
    set(wrong "is installed and includes what is not")
    set(known ${PUBLIC} ${DETAILS})
    if(header STREQUAL "anamorph/anamorph.h")
        foreach(public IN LISTS PUBLIC)
            if(NOT public IN_LIST includes AND NOT public STREQUAL header)
                message(SEND_ERROR "${header} does not include ${public}")
            endif()
        endforeach()
        set(wrong "includes what is not public")
        set(known ${PUBLIC})
    endif()
    list(REMOVE_ITEM includes ${known})
    if(includes)
        message(SEND_ERROR "${header} ${wrong}: ${includes}")
    endif()
endforeach()
list(REMOVE_ITEM DETAILS ${all_included})
if(DETAILS)
    message(SEND_ERROR "installed, and included by none that is public: ${DETAILS}")
endif()
