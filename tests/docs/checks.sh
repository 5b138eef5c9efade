# Checks of the commands that documentation names. Included by the scripts of this folder, which set $claray and define `fail`.
# Names that are upper-case stand for something else.
# shellcheck shell=bash disable=SC2154
scenes=$("$claray" scenes | awk '{print $1}') cases=$("$claray" verify --list | awk '{print $1}')
declare -A help

check_scene() {
    case $1 in
        *[A-Z]*) ;;
        effect:*) grep -qE "(\`|effect:)${1#effect:}(\`| )" docs/effects.md || fail "no effect $1" ;;
        *:[0-9]*) grep -qx "${1%%:*}:N" <<< "$scenes" || fail "no scene $1" ;;
        *.*) ;;  # a file
        *) grep -qx "$1" <<< "$scenes" || fail "no scene $1" ;;
    esac
}

check_program() {
    local command=$1 scene='' word previous=''; shift
    [[ -n ${help[$command]:-} ]] || help[$command]=$("$claray" "$command" --help-all)
    grep -q "^Usage: claray $command" <<< "${help[$command]}" || { fail "no command $command"; return; }
    for word in "$@"; do
        case $word in
            --*) grep -qE -- "${word%%=*}([ ,[]|\$)" <<< "${help[$command]}" || fail "claray $command has no option $word" ;;
        esac
        [[ $previous == --case ]] && { grep -qx "$word" <<< "$cases" || fail "verify has no case $word"; }
        [[ $command == accuracy && $previous == --only ]] && { grep -qw -- "$word" <<< "${help[accuracy]#*Studies:}" || fail "no study $word"; }
        [[ -z $scene && -z $previous && $word != -* ]] && grep -qE "^Usage: .* \[?scenes?\b" <<< "${help[$command]}" && { scene=$word; check_scene "$scene"; }
        previous=$word
    done
}

# A filter of GoogleTest: at least one test of the folder matches.
check_tests() {
    local test
    while read -r test; do
        # shellcheck disable=SC2053  # a pattern
        [[ $test == $2 ]] && return
    done < <(grep -rhoE '^TEST(_P|_F)?\([A-Za-z0-9_]+, [A-Za-z0-9_]+' "tests/$1" | sed -E 's/^TEST(_P|_F)?\(//; s/, /./')
    fail "no test $2 in tests/$1"
}
