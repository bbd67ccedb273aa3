# SPDX-License-Identifier: Apache-2.0
# Makes the pages of the public headers. Every warning of Doxygen is an error, but for what needs no comment where its
# name, type and class say it all: variables of classes, their functions without arguments, and what is inherited or default.
# Needs: DOXYGEN, DOXYFILE, SOURCE_DIR (of the core), DOCS_DIR (emptied).
file(REMOVE_RECURSE ${DOCS_DIR})
file(MAKE_DIRECTORY ${DOCS_DIR})
execute_process(COMMAND ${DOXYGEN} ${DOXYFILE} WORKING_DIRECTORY ${SOURCE_DIR} COMMAND_ERROR_IS_FATAL ANY)
file(STRINGS ${DOCS_DIR}/warnings.txt warnings)
set(of_class "of (struct|class) [^ ]+ is not documented")
list(FILTER warnings EXCLUDE REGEX "warning: Member .* \\((variable|friend)\\) ${of_class}")
list(FILTER warnings EXCLUDE REGEX "warning: Member [^ ()]+\\(\\) .*\\(function\\) ${of_class}")
list(FILTER warnings EXCLUDE REGEX "warning: Member .*( override|=default|&&\\) noexcept) \\(function\\) ${of_class}")
if(warnings)
    list(LENGTH warnings count)
    list(JOIN warnings "\n" warnings)
    message(NOTICE "${warnings}")
    message(FATAL_ERROR "${count} warnings of Doxygen")
endif()
if(NOT EXISTS ${DOCS_DIR}/html/index.html)
    message(FATAL_ERROR "${DOCS_DIR}/html: no pages")
endif()
