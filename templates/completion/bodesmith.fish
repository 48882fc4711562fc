# Completion of bodesmith for fish, made by `bodesmith completion fish`.

# Whether the words typed so far name this subcommand (and no verb below it).
function __bodesmith_at
    set -l typed (commandline -opc)
    set -e typed[1]
    if test (count $argv) -eq 2
        test "$typed[1]" = $argv[1]; and test "$typed[2]" = $argv[2]
        return
    end
    test "$typed[1]" = $argv[1]; or return 1
    switch "$argv[1] $typed[2]"
{{#top}}
{{#verbs}}
        case '{{command}} {{name}}'
            return 1
{{/verbs}}
{{/top}}
    end
    return 0
end

function __bodesmith_at_verb
    set -l typed (commandline -opc)
    test (count $typed) -eq 2; and test "$typed[2]" = $argv[1]
end

{{#top}}
complete -c bodesmith -n __fish_use_subcommand -f -a {{name}} -d '{{what}}'
{{#verbs}}
complete -c bodesmith -n '__bodesmith_at_verb {{command}}' -a {{name}} -d '{{what}}'
{{/verbs}}
{{/top}}
complete -c bodesmith -n __fish_use_subcommand -l help -d 'the subcommands'
complete -c bodesmith -n __fish_use_subcommand -l version -d 'the version'
{{#commands}}
{{#options}}
complete -c bodesmith -n '__bodesmith_at {{command}}' -l {{name}}{{#letter}} -s {{letter}}{{/letter}}{{#chooses}} -x -a '{{words}}'{{/chooses}}{{#any_value}} -r{{/any_value}} -d '{{what}}'
{{/options}}
{{#has_words}}
complete -c bodesmith -n '__bodesmith_at {{name}}' -f -a '{{words}}'
{{/has_words}}
{{/commands}}
