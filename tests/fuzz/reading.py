"""Malformed files in this process, for kinds of files that the tests at hand make."""

import re
import warnings
from pathlib import Path

from frictionmap import InputError
from frictionmap.files.reading import read
from frictionmap.files.summary import describe_file

from . import malformed


def refused(base: Path, family: str, count: int) -> int:
    """How many malformed files made from `base` are refused, each in one line that names the file."""
    path, found = base.with_name("malformed.nc"), 0
    for seed in range(count):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the libraries, about such files
            what = malformed.make(base, family, seed, path)
            try:
                describe_file(read(path))
                continue
            except InputError as error:
                message = str(error)
        found += 1
        assert re.fullmatch(rf"(file|cannot read) {re.escape(str(path))}\b.*", message), what
    return found
