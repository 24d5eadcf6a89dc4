"""A cell begins at the polynomial through the steady states of the last cells of its row."""

from .compiler import kernel

#: Cells that point to the next one, and the farthest that it may be, in steps between the last two.
CELLS = 5
_FARTHEST = 3.0


@kernel
def reaches(places, known, place):
    """Whether a place is near enough to be extrapolated to.

    Parameters
    ----------
    places : places of the last cells, latest first
    known : how many there are, at most CELLS
    place : of the next cell
    """
    return known >= 2 and abs(place - places[0]) <= _FARTHEST * abs(places[0] - places[1])


@kernel
def weight(places, known, k, place):
    """Weight of the k-th of the last cells: that of Lagrange; see `reaches`."""
    product = 1.0
    for other in range(known):
        if other != k:
            product *= (place - places[other]) / (places[k] - places[other])
    return product
