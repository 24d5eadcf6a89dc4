"""The program: `python -m frictionmap`, and `frictionmap` where it is installed."""

import contextlib
import gc
import os
import sys
import warnings

from .command_line import interrupts


def _open_streams() -> None:
    """Open descriptors 0-2 if closed, so that no output file is assigned one."""
    with contextlib.suppress(OSError):
        while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
            pass
        os.close(handle)


def _flush() -> int:
    """Flush stdout; return the exit status."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
        return 0
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or Python tries again when it ends
        if isinstance(error, BrokenPipeError):  # the reader has closed the pipe
            return 0
        print(f"frictionmap: cannot print: {error.strerror}; output is lost", file=sys.stderr)
        return 1


def run() -> int:
    """Run the program as a process; return the exit status."""
    # matrices are small: threads that wait for work on them take up to 40 % of the processor's time
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _open_streams()
    interrupts.obey()
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # our own messages are errors; those of libraries are for developers
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    from .command_line.cli import main

    try:
        status = main()
    except SystemExit as ending:  # after --help, and after invalid arguments
        status = int(ending.code or 0)
    status = _flush() or status
    interrupts.ignore()
    gc.freeze()  # the process ends: a last garbage collection would take 0.2 s
    return status


if __name__ == "__main__":
    sys.exit(run())
