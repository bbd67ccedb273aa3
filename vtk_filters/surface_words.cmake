# SPDX-License-Identifier: Apache-2.0
# The surfaces of the core's list as words of vtkAnamorphDrape and of its proxy.

# anamorph_surface_words(LIST...): reads lists as surface/shape/list.h is, one after the other, and sets in the caller
#   drape_surface_count  how many there are, with that of the input Positions and that of formulas
#   drape_enumerators    of C++ and Python, such as PLANE = 0
#   drape_formula        the value of FORMULA
#   drape_menu, drape_labels, drape_zeros   of the proxy's properties Surface and BlendWeights
# Saved states have numbers: a surface keeps its own when others are added behind it, and POSITIONS and FORMULA always.
function(anamorph_surface_words)
    set(positions 7)
    set(names "")
    foreach(list IN LISTS ARGN)
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${list})
        file(STRINGS ${list} lines REGEX "^ANAMORPH_SURFACE\\(")
        list(TRANSFORM lines REPLACE "^ANAMORPH_SURFACE\\(([a-z0-9_]+),.*$" "\\1")
        list(APPEND names ${lines})
    endforeach()
    list(LENGTH names count)
    if(count LESS positions)
        message(FATAL_ERROR "${ARGN}: ${count} surfaces: must be at least ${positions}")
    endif()
    list(INSERT names ${positions} positions formula)
    set(value 0)
    foreach(name IN LISTS names)
        string(TOUPPER ${name} enumerator)
        list(APPEND enumerators "${enumerator} = ${value}")
        string(SUBSTRING ${enumerator} 0 1 initial)
        string(SUBSTRING ${name} 1 -1 rest)
        string(REPLACE "_" " " text "${initial}${rest}")
        string(APPEND menu "\n          <Entry value=\"${value}\" text=\"${text}\"/>")
        string(APPEND labels "\n            <ComponentLabel component=\"${value}\" label=\"${text}\"/>")
        list(APPEND zeros 0)
        math(EXPR value "${value} + 1")
    endforeach()
    list(JOIN enumerators ", " enumerators)
    list(JOIN zeros " " zeros)
    math(EXPR formula "${positions} + 1")
    set(drape_formula ${formula} PARENT_SCOPE)
    set(drape_surface_count ${value} PARENT_SCOPE)
    set(drape_enumerators "${enumerators}" PARENT_SCOPE)
    set(drape_menu "${menu}" PARENT_SCOPE)
    set(drape_labels "${labels}" PARENT_SCOPE)
    set(drape_zeros "${zeros}" PARENT_SCOPE)
endfunction()

# The lists that the core is compiled with.
set(surface_lists ${PROJECT_SOURCE_DIR}/core/anamorph/surface/shape/list.h)
set(toy_surface_lists ${surface_lists} ${PROJECT_SOURCE_DIR}/tests/toys/anamorph/surface/shape/list.h)
if(ANAMORPH_TOYS)
    set(surface_lists ${toy_surface_lists})
endif()
