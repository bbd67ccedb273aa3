# SPDX-License-Identifier: Apache-2.0
# Completion of anamorph, anamorph-figure and anamorph-machine in bash. Recipes with keys are quoted, since & and ? mean something to it.
_anamorph() {
    local words=("${COMP_WORDS[@]:1:COMP_CWORD}") program="${COMP_WORDS[0]}"
    words[-1]="${words[-1]#[\"\']}"
    mapfile -t COMPREPLY < <(anamorph complete -- "$program" "${words[@]}" 2>/dev/null)
    [[ ${COMPREPLY[0]} != *= ]] || compopt -o nospace
}
complete -o bashdefault -o default -F _anamorph anamorph anamorph-figure anamorph-machine
