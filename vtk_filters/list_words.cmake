# SPDX-License-Identifier: Apache-2.0
# The surfaces and the projections of the core's lists as enumerators of the VTK classes and as menus of their proxies.

# read_list(FILE REGEX RESULT): what the regular expression's first group matches in each line.
function(read_list file regex result)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(STRINGS ${file} lines REGEX "${regex}")
    list(TRANSFORM lines REPLACE "${regex}.*$" "\\1")
    set(${result} ${lines} PARENT_SCOPE)
endfunction()

# make_words(PREFIX NAME...): sets in the caller
#   PREFIX_count        how many names there are
#   PREFIX_enumerators  of C++ and Python, such as PLANE = 0, CUBEMAP_3X2 = 8
#   PREFIX_menu         entries of a menu of ParaView
#   PREFIX_labels       of a property with one number for each
#   PREFIX_zeros        as many zeros
function(make_words prefix)
    set(value 0)
    foreach(name IN LISTS ARGN)
        string(REGEX REPLACE "([a-z])([0-9]+x[0-9])" "\\1_\\2" spaced ${name})
        string(TOUPPER ${spaced} enumerator)
        list(APPEND enumerators "${enumerator} = ${value}")
        string(SUBSTRING ${enumerator} 0 1 initial)
        string(SUBSTRING ${spaced} 1 -1 rest)
        string(REPLACE "_" " " text "${initial}${rest}")
        string(REGEX REPLACE "([0-9])x([0-9])" "\\1 x \\2" text "${text}")
        string(APPEND menu "\n          <Entry value=\"${value}\" text=\"${text}\"/>")
        string(APPEND labels "\n            <ComponentLabel component=\"${value}\" label=\"${text}\"/>")
        list(APPEND zeros 0)
        math(EXPR value "${value} + 1")
    endforeach()
    list(JOIN enumerators ", " enumerators)
    list(JOIN zeros " " zeros)
    foreach(word menu labels zeros enumerators)
        set(${prefix}_${word} "${${word}}" PARENT_SCOPE)
    endforeach()
    set(${prefix}_count ${value} PARENT_SCOPE)
endfunction()

# anamorph_list_words(surfaces LIST... projections LIST...): the words drape_... of the surfaces, with that of the input Positions
# and that of formulas, drape_formula, the value of FORMULA, and projection_... of the projections.
# Saved states have numbers: a surface and a projection keep their own when others are added behind them, and POSITIONS and
# FORMULA always.
macro(anamorph_list_words)
    cmake_parse_arguments(lists "" "" "surfaces;projections" ${ARGN})
    set(positions 7)
    set(surfaces "")
    foreach(list IN LISTS lists_surfaces)
        read_list(${list} "^ANAMORPH_SURFACE\\(([a-z0-9_]+)," names)
        list(APPEND surfaces ${names})
    endforeach()
    list(LENGTH surfaces count)
    if(count LESS positions)
        message(FATAL_ERROR "${lists_surfaces}: ${count} surfaces: must be at least ${positions}")
    endif()
    list(INSERT surfaces ${positions} positions formula)
    math(EXPR drape_formula "${positions} + 1")
    make_words(drape ${surfaces})

    set(projections "")
    foreach(list IN LISTS lists_projections)
        read_list(${list} "^ANAMORPH_PROJECTION\\(([a-z0-9_]+)," names)
        list(APPEND projections ${names})
    endforeach()
    make_words(projection ${projections})
endmacro()

# The lists that the core is compiled with.
set(surface_lists ${PROJECT_SOURCE_DIR}/core/anamorph/surface/shape/list.h)
set(projection_lists ${PROJECT_SOURCE_DIR}/core/anamorph/chart/projection/list.h)
set(toy_surface_lists ${surface_lists} ${PROJECT_SOURCE_DIR}/tests/toys/anamorph/surface/shape/list.h)
set(toy_projection_lists ${projection_lists} ${PROJECT_SOURCE_DIR}/tests/toys/anamorph/chart/projection/list.h)
if(ANAMORPH_TOYS)
    set(surface_lists ${toy_surface_lists})
    set(projection_lists ${toy_projection_lists})
endif()
anamorph_list_words(surfaces ${surface_lists} projections ${projection_lists})
