"""The map of a system in a browser, on this machine only: `frictionmap explore`, `fm.explore`.

=================  ===========================================================================================
module             what is in it
=================  ===========================================================================================
scene_parts        sliders, contacts and boundaries that a page offers
contacts           contacts to choose from: places of the only one, or which of several is shown
law_numbers        numbers of friction over speed that a slider changes
sliders            numbers of a system that can be changed
scene              subject of a page: system, initial view, parameters that can be changed
views              one view: changed system, ranges of r and beta, mu
belt_classes       motions on a belt without a load: classes of cells, and quantities that colour them
quantities         what the cells of a map show: classes of their regime, or a quantity
queries            queries of the page, checked like a configuration
structure_picture  the picture of a beam or a plate with its points and contacts
unloaded           maps on a belt without a load: cells, and limits as lines
lines              boundaries of a view: values, and how the page draws them
pieces             pieces of a map for the page: cells, classes, quantities, boundaries
example            cell whose motion the page opens with
drawing            drawing of a system in motion: masses, springs, contacts, loads
numbers            numbers of a cell, as the page lists them
sentences          a motion in sentences: what the contacts do, and why
unloaded_motion    one motion on a belt without a load: numbers, words, curves
cell               one cell: its motion, and that from another initial state
cut                response curves through a view
subjects           responses that a goal can be about
goal               the friction that meets the goal of a design
typed              numbers typed into the page as ratios: they may have units
packets            binary packets for the page
presets            systems that the page offers besides its own
scene_description  description of a scene for the page: names, ranges, parameters that can be changed, colours
rehearsal          small computations of every kind, so that kernels are compiled before they are needed
compile_times      time that kernels take to compile on this machine
jobs               running requests, cancellation, state of compilation
downloads          a view as a configuration, NetCDF or CSV
in_time            motions in time under records: what their page offers and asks for
server             HTTP server, for this machine only
stored             the page as one file with precomputed maps
notebook           the page in a notebook
page               source of the page: HTML, CSS, modules of JavaScript
=================  ===========================================================================================
"""
