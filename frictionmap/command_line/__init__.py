"""The command line; modules that load slowly are imported inside functions, so that `--help` is fast.

==========  =================================================================================
module      what is in it
==========  =================================================================================
interrupts  Ctrl-C and termination: the program ends at once and removes its unfinished files
arguments   every command with its options and help texts
completion  completion scripts for shells
progress    progress of a long run, on standard error
cli         `main`: what each command calls, prints and writes
==========  =================================================================================
"""
