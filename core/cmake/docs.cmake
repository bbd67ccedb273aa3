# SPDX-License-Identifier: Apache-2.0
# Makes the pages of the public headers. Every warning of Doxygen is an error, but for members of classes without a comment:
# many have none, because their name, type and class say it all.
# Needs: DOXYGEN, DOXYFILE, SOURCE_DIR (of the core), DOCS_DIR (emptied).
file(REMOVE_RECURSE ${DOCS_DIR})
file(MAKE_DIRECTORY ${DOCS_DIR})
execute_process(COMMAND ${DOXYGEN} ${DOXYFILE} WORKING_DIRECTORY ${SOURCE_DIR} COMMAND_ERROR_IS_FATAL ANY)
file(STRINGS ${DOCS_DIR}/warnings.txt warnings)
list(FILTER warnings EXCLUDE REGEX "warning: Member .* of (struct|class) [^ ]+ is not documented")
if(warnings)
    list(LENGTH warnings count)
    list(JOIN warnings "\n" warnings)
    message(NOTICE "${warnings}")
    message(FATAL_ERROR "${count} warnings of Doxygen")
endif()
if(NOT EXISTS ${DOCS_DIR}/html/index.html)
    message(FATAL_ERROR "${DOCS_DIR}/html: no pages")
endif()
