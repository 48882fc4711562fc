# Completion of bodesmith for bash, made by `bodesmith completion bash`.

_bodesmith_options() {
  case "$1" in
{{#commands}}
    '{{name}}') echo '{{dashed}}' ;;
{{/commands}}
    *) echo '--help --version' ;;
  esac
}

# What may follow an option: its words, "any" for a text, a number or a file, nothing after a flag.
_bodesmith_values() {
  case "$1 $2" in
{{#commands}}
{{#options}}
{{#chooses}}
    '{{command}} --{{name}}') echo '{{words}}' ;;
{{/chooses}}
{{#any_value}}
    '{{command}} --{{name}}'{{#letter}} | '{{command}} -{{letter}}'{{/letter}}) echo any ;;
{{/any_value}}
{{/options}}
{{/commands}}
  esac
}

# Words that stand in the place of files, and how the files end otherwise.
_bodesmith_operands() {
  case "$1" in
{{#commands}}
{{#has_words}}
    '{{name}}') echo '{{words}}' ;;
{{/has_words}}
{{#files}}
    '{{name}}') echo '{{files}}' ;;
{{/files}}
{{/commands}}
  esac
}

_bodesmith_verbs() {
  case "$1" in
{{#top}}
{{#has_verbs}}
    '{{name}}') echo '{{verb_names}}' ;;
{{/has_verbs}}
{{/top}}
  esac
}

_bodesmith_files() {
  local patterns pattern IFS
  IFS=' ' read -ra patterns <<< "$1"
  IFS=$'\n'
  compopt -o filenames 2>/dev/null
  if [[ ${#patterns[@]} -gt 0 ]]; then
    for pattern in "${patterns[@]}"; do
      COMPREPLY+=($(compgen -f -X "!$pattern" -- "$2"))
    done
    COMPREPLY+=($(compgen -d -- "$2"))
    [[ ${#COMPREPLY[@]} -gt 0 ]] && return
  fi
  COMPREPLY+=($(compgen -f -- "$2"))
}

_bodesmith() {
  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]} first=1 verbs word
  COMPREPLY=()
  if [[ $COMP_CWORD -eq 1 ]]; then
    COMPREPLY=($(compgen -W '{{top_names}} --help --version' -- "$current"))
    return
  fi
  verbs=$(_bodesmith_verbs "$command")
  for word in $verbs; do
    if [[ $COMP_CWORD -gt 2 && ${COMP_WORDS[2]} == "$word" ]]; then
      command="$command $word"
      first=2
    fi
  done
  # --name=value comes as three words.
  if [[ $current == '=' ]]; then
    current=''
  elif [[ $before == '=' ]]; then
    before=${COMP_WORDS[COMP_CWORD-2]}
  fi
  local values=$(_bodesmith_values "$command" "$before")
  if [[ $values == any ]]; then
    _bodesmith_files '' "$current"
    return
  elif [[ -n $values ]]; then
    COMPREPLY=($(compgen -W "$values" -- "$current"))
    return
  fi
  if [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$(_bodesmith_options "$command")" -- "$current"))
    return
  fi
  if [[ $COMP_CWORD -eq 2 && -n $verbs ]]; then
    COMPREPLY=($(compgen -W "$verbs" -- "$current"))
  fi
  local operands
  operands=$(_bodesmith_operands "$command")
  if [[ -n $operands && $operands != \** ]]; then
    COMPREPLY+=($(compgen -W "$operands" -- "$current"))
  else
    _bodesmith_files "$operands" "$current"
  fi
}

complete -F _bodesmith bodesmith
