"""The command line; everything heavy is imported late: `--help` takes no time.

==========  ===========================================================================
module      what is in it
==========  ===========================================================================
interrupts  Ctrl-C and termination: the program ends at once and clears away its claims
arguments   every command with its options and help texts
completion  completion scripts for shells
progress    what a long run is at, on standard error
cli         `main`: what each command calls, prints and writes
==========  ===========================================================================
"""
