# SPDX-License-Identifier: Apache-2.0
function __anamorph_words
    # Recipes stand in quotes, which are none of the word.
    set -l last (string replace -r '^["\']' '' -- (commandline -ct))
    anamorph complete -- (commandline -opc) "$last" 2>/dev/null
end
for program in anamorph anamorph-figure anamorph-machine
    complete -c $program -a '(__anamorph_words)'
end
