"""Invalid input, interrupts and damaged files: nothing lost, nothing left behind, no traceback.

    python -m pytest tests/fuzz             some trials of every kind
    python -m pytest tests/fuzz --whole     all of them, more than 7,000 in an hour

They are tried in child processes only.  A trial succeeds if it ends with a correct result, or with a message
of one line that names the cause.  Failures are counted by what a user sees, with examples.

==============  =========================================================================================
module          what is in it
==============  =========================================================================================
configurations  invalid configurations: every key with wrong values, invalid files, invalid matrices
command_lines   invalid command lines: arguments, overrides, outputs and inputs
refusals        runs both: refused in one line that names the cause, with nothing changed
calls           invalid calls of the Python API, valid ones in unusual form, settings
mutants         thousands of malformed files, read by `info` and `plot`
moments         duration and output of every command
interrupts      SIGINT, SIGTERM and SIGKILL at random moments of every command
races           several runs that write the same file, files that appear during a run, links
places          full disks, read-only folders, terminals with few characters, closed streams
caches          damaged caches of kernels, read-only machines
damages         damage to a cache
malformed       makes malformed files from `contents` by `other_structure`, `other_values`, `slices`
calling         makes the calls; runs in the child
worker          the child's side
child           the parent's side
machine         new processes, and how busy the machine is
folders         content of a folder before and after
verdict         defects of a run; counts
test_fuzz       every part as a test
test_harness    the trials see every fault: tried on a stand-in that does everything wrong
==============  =========================================================================================
"""
