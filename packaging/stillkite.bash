# Completion of stillkite in bash: subcommands and options as --help lists them.
_stillkite() {
  local cur prev words cword word subcommand=
  _init_completion -s || return
  for word in "${words[@]:1:cword-1}"; do
    if [[ $word != -* ]]; then
      subcommand=$word
      break
    fi
  done
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(
      compgen -W "$(_parse_help "$1" "${subcommand:+$subcommand }--help")" -- "$cur")
  elif [[ -z $subcommand ]]; then
    mapfile -t COMPREPLY < <(
      compgen -W "$("$1" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p')" -- "$cur")
  else
    _filedir
  fi
} && complete -F _stillkite stillkite
