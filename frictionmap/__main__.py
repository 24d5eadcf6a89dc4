"""The program: `python -m frictionmap`, and `frictionmap` where it is installed."""

import contextlib
import os
import sys
import warnings

from .command_line import interrupts


def _open_streams() -> None:
    """Descriptors 0 to 2 are open: else a file of ours would get one, and messages would land in it."""
    with contextlib.suppress(OSError):
        while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
            pass
        os.close(handle)


def _flush() -> int:
    """What was printed has arrived; the exit status."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
        return 0
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or Python tries again when it ends
        if isinstance(error, BrokenPipeError):  # whoever reads it has had enough
            return 0
        print(f"frictionmap: what was to be printed is lost ({error.strerror})", file=sys.stderr)
        return 1


def run() -> int:
    """Run the program as a process of its own; the exit status."""
    _open_streams()
    interrupts.obey()
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # messages of ours are errors; others' are for developers
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    from .command_line.cli import main

    try:
        status = main()
    except SystemExit as ending:  # of help and of arguments that are wrong
        status = int(ending.code or 0)
    status = _flush() or status
    interrupts.ignore()
    return status


if __name__ == "__main__":
    sys.exit(run())
