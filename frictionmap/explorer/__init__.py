"""The map of a system in a browser, on this machine only: `frictionmap explore`, `fm.explore`.

==========  ================================================================================
module      what is in it
==========  ================================================================================
scene       what is explored: the system, where the view begins, what can be changed
views       one view: a system as changed, ranges of r and beta, mu; its map, piece by piece
cell        one cell of it: its motion in numbers, words and curves, and what other starts give
cut         a line through it as response curves
queries     what the page asks for, checked as a configuration is
packets     numbers on their way to the page
told        what the page is told first: names, ranges, what can be changed, colours
jobs        what is being computed, what is outdated, whether kernels are being compiled
downloads   a view as a configuration, NetCDF or CSV
server      the standard library's HTTP server, for this machine only
stored      the page as one file with maps that are computed beforehand
notebook    the page in a notebook
page        what the browser runs, as it is written: HTML, CSS, modules of JavaScript
==========  ================================================================================
"""
