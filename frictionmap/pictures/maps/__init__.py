"""Pictures over frequency and friction.

===============  =======================================================
module           what is in it
===============  =======================================================
raster           cells to pixels, without losing small features
boundary_curves  boundaries over a map, at the resolution of the picture
cell_image       cells as pixels, or as rectangles in vector files
stop_borders     borders between numbers of stops
working_point    a working point with the box of its uncertainty
regime_map       maps of regimes and stops
quantity_map     maps of amplitudes, work and other numbers
boundary_map     maps of the boundaries alone
share_map        maps of probabilities
belt_map         regimes over belt speed and friction, without a load
force_map        two contacts at one frequency, friction against friction
===============  =======================================================
"""
