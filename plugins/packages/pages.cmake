# SPDX-License-Identifier: Apache-2.0
# Manual pages, made of what the programs say of themselves: the target pages.
set(pages_targets "")
find_program(ANAMORPH_HELP2MAN help2man)
mark_as_advanced(ANAMORPH_HELP2MAN)
if(NOT ANAMORPH_HELP2MAN)
    message(STATUS "help2man is not there: the packages will have no manual pages")
    return()
endif()

# page(TARGET COMPONENT NAME SUMMARY)
set(pages "")
function(page target component name summary)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}.1.gz)
    add_custom_command(OUTPUT ${file}
        COMMAND sh -c "SOURCE_DATE_EPOCH=\${SOURCE_DATE_EPOCH:-0} '${ANAMORPH_HELP2MAN}' --no-info --help-option=--help-all --name '${summary}' --version-string 'Anamorph ${PROJECT_VERSION}' '$<TARGET_FILE:${target}>' | gzip -9nc > '${file}'"
        DEPENDS ${target} COMMENT "Manual page of ${name}" VERBATIM)
    install(FILES ${file} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component} EXCLUDE_FROM_ALL)
    list(APPEND pages ${file})
    set(pages ${pages} PARENT_SCOPE)
endfunction()
page(anamorph_program programs anamorph "image warping with a proven tolerance")
page(anamorph_figure programs anamorph-figure "figures of ellipsoids, drawn and moved")
page(anamorph_machine programs anamorph-machine "what the graphics hardware of 1987 and 2003 would have drawn")
if(TARGET anamorph_pictures)
    page(anamorph_pictures openimageio anamorph-pictures "hashes, pictures and parts of recipes")
endif()
add_custom_target(pages ALL DEPENDS ${pages})
list(APPEND pages_targets pages)
