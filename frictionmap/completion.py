"""Completion of the command line: scripts that bash, zsh and fish read when they start.

They are made from the arguments themselves and hold all words: the program does not run when the Tab key is
pressed.
"""

import re
from collections.abc import Iterator, Mapping, Sequence

from .arguments import Argument, Command

#: Files that stand behind these names; of others the name says the ending.
_FILES = {"FILE": ("nc", "zarr"), "PICTURE": ("png", "pdf", "svg"), "OUT": ("nc", "csv")}

#: Keys of configurations by command; those of "" where a command has none of its own.
Settings = Mapping[str, Sequence[str]]


def completion(shell: str, commands: Sequence[Command], settings: Settings) -> str:
    """The script for a shell.

    shell : "bash", "zsh" or "fish"
    settings : what `--set` may change, by command
    """
    return {"bash": _bash, "zsh": _zsh, "fish": _fish}[shell](commands, settings)


def _endings(argument: Argument) -> tuple[str, ...]:
    """Endings of the files that an argument names; none: it names no file."""
    return _FILES.get(argument.metavar) or tuple(re.findall(r"\.([a-z]+)", argument.metavar))


def _words(command: Command, argument: Argument, settings: Settings) -> list[str]:
    """Words that may stand for a value."""
    if argument.metavar == "KEY=VALUE":
        return [f"{key}=" for key in settings.get(command.name, settings[""])]
    return list(argument.choices)


def _named(command: Command) -> list[Argument]:
    return [argument for argument in command.arguments if argument.flags]


def _placed(command: Command) -> list[Argument]:
    return [argument for argument in command.arguments if not argument.flags]


# bash


def _bash(commands: Sequence[Command], settings: Settings) -> str:
    cases = "\n".join(_bash_case(command, settings) for command in commands)
    names = " ".join(command.name for command in commands)
    return f"""\
# eval "$(frictionmap completion bash)"
_frictionmap_files() {{
    local ending
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -d -- "$1"; for ending in "${{@:2}}"; do
        compgen -f -X "!*.$ending" -- "$1"; done)
}}
_frictionmap_words() {{
    [[ $2 == *= ]] && compopt -o nospace
    mapfile -t COMPREPLY < <(compgen -W "$2" -- "$1")
}}
_frictionmap() {{
    local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}}
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        _frictionmap_words "$cur" "{names} --help --version"
        return
    fi
    case ${{COMP_WORDS[1]}} in
{cases}
    esac
}}
complete -F _frictionmap frictionmap"""


def _bash_case(command: Command, settings: Settings) -> str:
    lines = [f"    {command.name})", "        case $prev in"]
    for argument in _named(command):
        if argument.metavar:
            value = _bash_value(command, argument, settings)
            lines.append(f"        {'|'.join(argument.flags)}) {value}; return ;;")
    lines += ["        esac", "        if [[ $cur == -* ]]; then"]
    flags = " ".join(flag for argument in _named(command) for flag in argument.flags)
    lines.append(f'            _frictionmap_words "$cur" "{flags}"; return')
    lines.append("        fi")
    lines += [f"        {_bash_value(command, argument, settings)}" for argument in _placed(command)]
    return "\n".join([*lines, "        ;;"])


def _bash_value(command: Command, argument: Argument, settings: Settings) -> str:
    words = _words(command, argument, settings)
    if words:
        return f'_frictionmap_words "$cur" "{" ".join(words)}"'
    endings = _endings(argument)
    return f'_frictionmap_files "$cur" {" ".join(endings)}' if endings else ":"


# zsh


def _zsh(commands: Sequence[Command], settings: Settings) -> str:
    names = "\n".join(f"        {_single(f'{command.name}:{command.help}')}" for command in commands)
    cases = "\n".join(_zsh_case(command, settings) for command in commands)
    return f"""\
#compdef frictionmap
# eval "$(frictionmap completion zsh)", or this text as the file _frictionmap in a folder of $fpath
_frictionmap() {{
    local -a commands
    commands=(
{names}
    )
    if ((CURRENT == 2)); then
        _describe command commands
        return
    fi
    local command=$words[2]
    shift words
    ((CURRENT--))
    case $command in
{cases}
    esac
}}
if [[ $funcstack[1] == _frictionmap ]]; then
    _frictionmap "$@"
else
    compdef _frictionmap frictionmap
fi"""


def _zsh_case(command: Command, settings: Settings) -> str:
    specs = []
    for argument in _named(command):
        text = re.sub(r"[\[\]:]", r"\\\g<0>", argument.help)
        value = f":{_zsh_value(command, argument, settings)}" if argument.metavar else ""
        again = "*" if argument.metavar == "KEY=VALUE" else ""
        specs += [f"{again}{flag}[{text}]{value}" for flag in argument.flags]
    specs += [
        f"{place}:{_zsh_value(command, argument, settings)}"
        for place, argument in enumerate(_placed(command), start=1)
    ]
    lines = " \\\n            ".join(_single(spec) for spec in specs)
    return f"    {command.name})\n        _arguments \\\n            {lines}\n        ;;"


def _zsh_value(command: Command, argument: Argument, settings: Settings) -> str:
    words, endings = _words(command, argument, settings), _endings(argument)
    what = argument.metavar.replace(":", " ")
    if words and words[0].endswith("="):
        return f'{what}:compadd -S "" -- {" ".join(words)}'
    if words:
        return f"{what}:({' '.join(words)})"
    one_of = endings[0] if len(endings) == 1 else f"({'|'.join(endings)})"  # (toml) alone would be qualifiers
    return f'{what}:_files -g "*.{one_of}"' if endings else f"{what}: "


# fish


def _fish(commands: Sequence[Command], settings: Settings) -> str:
    lines = ["# frictionmap completion fish | source", "complete -c frictionmap -f"]
    for command in commands:
        help_text = _single(command.help, fish=True)
        lines.append(f"complete -c frictionmap -n __fish_use_subcommand -a {command.name} -d {help_text}")
        lines += _fish_lines(command, settings)
    return "\n".join(lines)


def _fish_lines(command: Command, settings: Settings) -> Iterator[str]:
    begin = f"complete -c frictionmap -n '__fish_seen_subcommand_from {command.name}'"
    for argument in _named(command):
        flags = " ".join(
            f"-l {flag[2:]}" if flag.startswith("--") else f"-s {flag[1:]}" for flag in argument.flags
        )
        value = _fish_value(command, argument, settings) if argument.metavar else ""
        yield f"{begin} {flags}{value} -d {_single(argument.help, fish=True)}"
    for argument in _placed(command):
        yield f"{begin}{_fish_value(command, argument, settings)}"


def _fish_value(command: Command, argument: Argument, settings: Settings) -> str:
    words, endings = _words(command, argument, settings), _endings(argument)
    taken = " -x" if argument.flags else ""
    if words:
        return f"{taken} -a {_single(' '.join(words), fish=True)}"
    kept = rf".*(?:/|\.(?:{'|'.join(endings)}))(?=\s*\$)"  # each is followed by a tab
    found = f'__fish_complete_path (commandline -ct) | string match -r "{kept}"'
    return f"{taken} -a '({found})'" if endings else taken


def _single(text: str, *, fish: bool = False) -> str:
    """`text` between single quotes."""
    if fish:
        return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
    return "'" + text.replace("'", "'\\''") + "'"
