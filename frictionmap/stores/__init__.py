"""Large maps, computed block by block into a zarr store.

=========  =============================================================================
module     what is in it, in the order in which data flows
=========  =============================================================================
study      what is computed: systems, grid, settings; its blocks
cuts       where it is cut into blocks, by what its cells cost
layout     the arrays of a store: their dimensions, types and chunks
store      a store on disk: made, recognised, tidied; blocks written and marked as done
run        one block after the other, in this process
workers    the same on processes of dask, here or elsewhere
=========  =============================================================================

A block is whole rows in r of one point of the study and one mu; small ones are computed and written in
batches.  Its mark is written last: whatever stops a run loses no more than the blocks under way.
"""
