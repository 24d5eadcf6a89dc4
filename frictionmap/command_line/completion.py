"""Shell completion, generated from the command-line parser by shtab.

The scripts contain all words, so the program does not run when the Tab key is pressed.
"""

import re
import shlex
from collections.abc import Mapping, Sequence

import shtab

from .arguments import Action, ArgumentParser, subcommands

#: Suffixes of the files that a metavar stands for; other metavars contain their suffixes.
_FILES = {"FILE": ("nc", "zarr"), "PICTURE": ("png", "pdf", "svg"), "OUT": ("nc", "csv")}

#: Words that may follow an option, by command; those of "" serve the commands that have none of their own.
Words = Mapping[str, Mapping[str, Sequence[str]]]

#: shtab's function runs in a subshell, where bash cannot be asked to leave out the space after "key=".
_BASH_NO_SPACE = """
_frictionmap() {
    _shtab_frictionmap "$@"
    [[ ${COMPREPLY[0]-} == *= ]] && compopt -o nospace
    return 0
}
complete -o bashdefault -F _frictionmap frictionmap
"""


def completion(parser: ArgumentParser, shell: str, words: Words) -> str:
    """Return the completion script of a shell.

    parser : of the whole command line; its arguments get the attribute `complete` that shtab reads
    shell : one of `shtab.SUPPORTED_SHELLS`
    words : what may follow an option such as "--set", by command
    """
    for name, sub in subcommands(parser).choices.items():
        for action in sub._actions:
            complete = _completer(action, words.get(name, {}), words[""])
            if complete is not None:
                action.complete = complete
    script = shtab.complete(parser, shell)
    return script + _BASH_NO_SPACE if shell == "bash" else script


def _completer(action: Action, own: Mapping, common: Mapping) -> dict | None:
    """Return what shtab needs to complete an argument: words or files; None: its choices, or nothing."""
    for flag in action.option_strings:
        if found := own.get(flag) or common.get(flag):
            return _word_completer(found)
    metavar = str(action.metavar or "")
    suffixes = _FILES.get(metavar) or re.findall(r"\.([a-z]+)", metavar)
    return shtab.glob(*(f"*.{suffix}" for suffix in suffixes)) if suffixes else None


def _word_completer(words: Sequence[str]) -> dict:
    """Return shtab's completer for fixed words; the shell adds no space behind one that ends in "="."""
    name = f"_frictionmap_words_{shtab.sha(words)}"
    listed = shlex.join(words)
    quoted = ", ".join(f"'{word}'" for word in words)
    return {
        "bash": name,
        "zsh": f"compadd -S '' -- {listed}" if words[0].endswith("=") else f"({listed})",
        "tcsh": f"({listed})",
        "fish": listed,
        "powershell": name,
        "preamble": {
            "bash": f'{name}() {{ compgen -W "{listed}" -- "$1"; }}',
            "powershell": f"function {name} {{ param([string]$WordToComplete) "
            f'@({quoted}) | Where-Object {{ $_ -like "$WordToComplete*" }} }}',
        },
    }
