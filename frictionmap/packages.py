"""Packages of extras, and files read by packages: what is said where one is missing or a file is damaged."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .errors import InputError


def package(name: str, path: Path, extra: str) -> Any:
    """A package of an extra that a file needs.

    Raises
    ------
    InputError
        It is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        missing = name.partition(".")[0]
        raise InputError(
            f"cannot read {path}: {missing} is not installed; run pip install 'frictionmap[{extra}]'"
        ) from None


def read_by(path: Path, form: str, read: Callable[[], Any]) -> Any:
    """What `read` makes of a file.

    Raises
    ------
    InputError
        Anything but trouble of the disk: of a file that is not of its form packages raise whatever comes.
    """
    try:
        return read()
    except (FileNotFoundError, InputError):
        raise
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"cannot read {path}: it is not a valid {form} ({reason}); write it again") from None
