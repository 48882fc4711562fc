#compdef bodesmith
# Completion of bodesmith for zsh, made by `bodesmith completion zsh`.

{{#commands}}
_bodesmith_{{id}}() {
  _arguments -s -S : \
{{#options}}
    {{#letter}}'(-{{letter}} --{{name}})'{-{{letter}},--{{name}}}'{{/letter}}{{^letter}}'{{#several}}*{{/several}}--{{name}}{{/letter}}[{{what}}]{{#chooses}}:{{name}}:({{words}}){{/chooses}}{{#any_value}}:{{name}}:_files{{/any_value}}' \
{{/options}}
    {{#has_words}}'*:kind:({{words}})'{{/has_words}}{{^has_words}}{{#files}}'*:file:_files -g "{{files}}"'{{/files}}{{^files}}'*:file:_files'{{/files}}{{/has_words}}
}

{{/commands}}
_bodesmith() {
  local -a subcommands verbs
  subcommands=(
{{#top}}
    '{{name}}:{{what}}'
{{/top}}
  )
  if (( CURRENT == 2 )); then
    _describe 'subcommand' subcommands
    _arguments '--help[the subcommands]' '--version[the version]'
    return
  fi
  local command=${words[2]}
  case $command in
{{#top}}
{{#has_verbs}}
    {{name}})
      verbs=(
{{#verbs}}
        '{{name}}:{{what}}'
{{/verbs}}
      )
      if (( CURRENT > 3 )) && [[ " {{verb_names}} " == *" ${words[3]} "* ]]; then
        command="{{name}}_${words[3]}"
        shift 2 words
        (( CURRENT -= 2 ))
      else
        (( CURRENT == 3 )) && _describe 'verb' verbs
        shift words
        (( CURRENT -= 1 ))
      fi
      ;;
{{/has_verbs}}
{{/top}}
    *)
      shift words
      (( CURRENT -= 1 ))
      ;;
  esac
  (( $+functions[_bodesmith_$command] )) && _bodesmith_$command
}

if [[ $funcstack[1] == _bodesmith ]]; then
  _bodesmith "$@"
else
  compdef _bodesmith bodesmith
fi
