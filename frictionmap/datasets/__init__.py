"""Datasets: names, units and valid values of variables; checks; provenance.

===============  ==================================================================
module           what is in it
===============  ==================================================================
labels           names, dimensions, types, units and meanings of all variables
estimate_labels  names, units and meanings of estimates from measured data
questions        design questions by their records, for all places that list them
design_labels    names, units and meanings of answers to design questions
motion_labels    names, units and meanings of motions in time
belt_labels      names, units and meanings of motions on a belt without a load
provenance       the history of a dataset, and the configuration that reproduces it
variables        arrays as labelled variables, and datasets with their attributes
schema           every variable checked against its label
physical         hertz, newtons and metres in addition to ratios
amounts          numbers of answers to design questions in words
===============  ==================================================================
"""
