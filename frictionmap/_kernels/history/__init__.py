"""Motions in time under records: loads and base motions that are polynomials over every interval.

The structure, its contacts, the series of a step and the events are those of `general`.

===============  ====================================================================
module           what is in it
===============  ====================================================================
kept             peaks, works, slides, events and samples of a motion in time
course           a record as polynomials over its intervals; what became of a motion under it
springs          springs under varying normal loads, where an interval begins
coupled_springs  springs that a residual flexibility couples, where an interval begins
tables           intervals in which nothing happens, by sums
held             what is held stays where it is
asleep           when a motion under no load has ended for all contacts
motion           the motion under a record: its start, an interval or a part of one, its end
spectrum_lanes   eight oscillators of one mass through samples without events
spectrum_sample  one of them through a sample with events
spectrum_rest    one of them after the record, until it rests
spectrum         peaks and stops of eight oscillators under a record
tangents         one mass under cubic pieces, with the derivatives of its motion
===============  ====================================================================
"""
