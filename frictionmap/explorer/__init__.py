"""The map of a system in a browser, on this machine only: `frictionmap explore`, `fm.explore`.

=================  ===========================================================================================
module             what is in it
=================  ===========================================================================================
scene              subject of a page: system, initial view, parameters that can be changed
views              one view: changed system, ranges of r and beta, mu; its map, in pieces
cell               one cell: its motion, and that from another initial state
cut                response curves through a view
queries            queries of the page, checked like a configuration
packets            binary packets for the page
scene_description  description of a scene for the page: names, ranges, parameters that can be changed, colours
jobs               running requests, cancellation, state of compilation
downloads          a view as a configuration, NetCDF or CSV
server             HTTP server, for this machine only
stored             the page as one file with precomputed maps
notebook           the page in a notebook
page               source of the page: HTML, CSS, modules of JavaScript
=================  ===========================================================================================
"""
