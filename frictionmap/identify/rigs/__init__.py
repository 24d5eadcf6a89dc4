"""Configurations of rigs: measured data and known parameters, for the command `identify`.

=============  =============================================================
module         what is in it
=============  =============================================================
rig            configuration of a rig, and the description of a kind of data
decay          free decays from the file of a rig
forced         forced responses from the file of a rig
history        records of any shape from the file of a rig
record         records of steady motion from the file of a rig
joint          several decays and records from the files of a rig
sweep          sweeps from the file of a rig
loop           damper tests from the file of a rig
configuration  configurations, read and checked; the kinds of data
keys           keys of these configurations, in words and as JSON Schema
=============  =============================================================
"""
