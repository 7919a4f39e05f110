# SPDX-License-Identifier: LGPL-2.1-or-later
# bash completion for hexaplast: what --help lists of the subcommand that the cursor is in, otherwise files.

# Options and subcommands at the beginnings of the lines that these words print with --help.
_hexaplast_words() {
  "$@" --help 2> /dev/null | awk '/^[A-Z]/ { lists = $1 == "Subcommands:" }
    /^ +-/ || lists && /^  [a-z]/ { gsub(",", " "); print $1; if ($2 ~ /^-/) print $2 }'
}

_hexaplast() {
  local current=${COMP_WORDS[COMP_CWORD]} path=("${COMP_WORDS[0]}") word words
  words=$(_hexaplast_words "${path[@]}")
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ $word != -* && $'\n'$words$'\n' == *$'\n'"$word"$'\n'* ]] || continue
    path+=("$word")
    words=$(_hexaplast_words "${path[@]}")
  done
  [[ $current == -* ]] || words=$(grep -v '^-' <<< "$words")
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}
complete -o default -F _hexaplast hexaplast
