"""Large maps and spectra, computed block by block into a zarr store.

=========  =============================================================================
module     what is in it
=========  =============================================================================
contents   what a store holds, and its division into blocks and batches
study      maps: systems, grid, settings
spectra    friction response spectra: records, oscillators
kinds      the contents of a store by their name
cuts       division into blocks, by computing time
layout     the arrays of a store: their dimensions, types and chunks
store      stores on disk: creation, identification, writing and marking of blocks
run        computation of missing blocks in this process
workers    computation of blocks by dask workers
spectrum   `spectrum`: friction response spectra in memory or in a store
=========  =============================================================================

A block consists of complete rows, in r at one point of the study and one mu, or in the period under one
record; small ones are computed and written in batches.  Its mark is written last, so that a stopped run loses
only the blocks in progress.
"""
