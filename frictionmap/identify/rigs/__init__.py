"""Configurations of rigs: measured data and what is known of them, for the command `identify`.

=============  ===============================================================================
module         what is in it
=============  ===============================================================================
rig            a rig: what a configuration says, and what a kind of data has to tell of itself
decay          free decays from the file of a rig
forced         forced responses from the file of a rig
record         records of steady motion from the file of a rig
joint          several decays and records from the files of a rig
sweep          sweeps from the file of a rig
configuration  configurations read and checked; the kinds of data
keys           their keys in words and as JSON Schema
=============  ===============================================================================
"""
