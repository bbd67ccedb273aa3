# SPDX-License-Identifier: Apache-2.0
# run(COMMAND...) sets `text` to what the command prints. One that fails ends the script with it.
function(run)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(status)
        list(JOIN ARGV " " command)
        message(FATAL_ERROR "${command}\nfailed (${status}):\n${text}")
    endif()
    set(text "${text}" PARENT_SCOPE)
endfunction()
