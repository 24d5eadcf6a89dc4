"""Packages of extras, and files read by them: errors for missing packages and damaged files."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .errors import InputError


def package(name: str, path: Path, extra: str) -> Any:
    """Import a package of an extra that a file needs.

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
    """Read a file through a package.

    Raises
    ------
    InputError
        Any error of the package except a missing file: packages raise various exceptions for invalid files.
    """
    try:
        return read()
    except (FileNotFoundError, InputError):
        raise
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"cannot read {path}: it is not a valid {form} ({reason}); write it again") from None
