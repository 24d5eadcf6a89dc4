"""
Your own structure: a plate that rubs at a corner
=================================================

A finite-element program writes mass and stiffness matrices to files. frictionmap reads and reduces them and
draws the map.  Here forty lines of NumPy replace the finite-element program.  The structure is a steel plate
of 0.6 m x 0.4 m x 4 mm with 3,600 degrees of freedom, clamped along one short edge.  One free corner is
pressed against a fixed wall and rubs on it.  A shaker drives the other free corner.
"""

# %%
# The plate
# ---------
# The plate consists of rectangular Kirchhoff elements with one deflection and two slopes per node.  The
# deflection is a polynomial with twelve terms, integrated at Gauss points.

from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np
import scipy.io
from scipy.sparse import coo_array

import frictionmap as fm

LENGTH, WIDTH, THICKNESS = 0.6, 0.4, 4e-3
YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0
ALONG, ACROSS = 40, 29  # elements

#: Powers of x and y in the deflection of an element.
POWERS = np.array(
    [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (3, 1), (1, 3)]
)


def terms(x, y, dx=0, dy=0):
    """The terms' derivatives at a point."""
    value = np.ones(len(POWERS))
    for at, order, power in ((x, dx, POWERS[:, 0]), (y, dy, POWERS[:, 1])):
        falling = np.prod([power - k for k in range(order)], axis=0) if order else 1.0
        value = value * falling * float(at) ** np.maximum(power - order, 0)
    return value


def element(a, b):
    """Mass and stiffness (12, 12) of an element a x b; deflection and slopes dw/dx, dw/dy of its corners."""
    corners = [(0.0, 0.0), (a, 0.0), (a, b), (0.0, b)]
    rows = [terms(x, y, *order) for x, y in corners for order in ((0, 0), (1, 0), (0, 1))]
    of_corners = np.linalg.inv(rows)
    rigidity = YOUNG * THICKNESS**3 / 12.0 / (1.0 - POISSON**2)
    bending = rigidity * np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, (1 - POISSON) / 2]])
    mass, stiffness = np.zeros((12, 12)), np.zeros((12, 12))
    points, weights = np.polynomial.legendre.leggauss(4)
    for s, p in zip(points, weights, strict=True):
        for t, q in zip(points, weights, strict=True):
            x, y, weight = a * (1 + s) / 2, b * (1 + t) / 2, p * q * a * b / 4
            curvature = np.array([terms(x, y, 2, 0), terms(x, y, 0, 2), 2 * terms(x, y, 1, 1)])
            mass += weight * DENSITY * THICKNESS * np.outer(terms(x, y), terms(x, y))
            stiffness += weight * curvature.T @ bending @ curvature
    return of_corners.T @ mass @ of_corners, of_corners.T @ stiffness @ of_corners


def assemble(part):
    """The matrix of the plate from that of an element; the nodes at x = 0 are clamped and left out."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(ALONG), np.arange(ACROSS), indexing="ij"))
    corners_of_each = [(0, 0), (1, 0), (1, 1), (0, 1)]
    nodes = np.stack([(i + di) * (ACROSS + 1) + j + dj for di, dj in corners_of_each], axis=1)
    dofs = (3 * nodes[:, :, np.newaxis] + np.arange(3)).reshape(len(nodes), 12) - 3 * (ACROSS + 1)
    rows, columns = np.broadcast_arrays(dofs[:, :, np.newaxis], dofs[:, np.newaxis, :])
    free = (rows >= 0) & (columns >= 0)
    values = np.broadcast_to(part, rows.shape)
    n = 3 * ALONG * (ACROSS + 1)
    return coo_array((values[free], (rows[free], columns[free])), shape=(n, n)).tocsr()


mass, stiffness = element(LENGTH / ALONG, WIDTH / ACROSS)
M, K = assemble(mass), assemble(stiffness)
corners = [3 * (ALONG - 1) * (ACROSS + 1) + 1, 3 * (ALONG * (ACROSS + 1) - 1) + 1]  # deflections, from 1
print(f"{M.shape[0]} degrees of freedom; the free corners are {corners}")

# %%
# Files
# -----
# Matrix Market stores one triangle of a symmetric matrix.  17 digits preserve every bit.

folder = Path(mkdtemp())
for name, matrix in (("m", M), ("k", K)):
    symmetric = 0.5 * (matrix + matrix.T)
    scipy.io.mmwrite(folder / f"{name}.mtx", symmetric, symmetry="symmetric", precision=17)

# %%
# The reduced structure
# ---------------------
# The reduction keeps both corners and twelve modes of the rest of the plate.  Its error is determined when a
# frequency range is requested.  An error above 0.1 % is refused, and the message states how many modes
# suffice.

plate = fm.System(
    contact="fixed-wall",
    contact_masses=[corners[0]],
    load_mass=corners[1],
    matrices={"M": folder / "m.mtx", "K": folder / "k.mtx"},
    reduce={"modes": 12},
    damping_ratios=0.005,
    stiffness_scale=1e3,
)
r = np.linspace(0.2, 8.0, 118)
print(plate.describe())
print(plate.costs(r)["reduction"])

# %%
# The map
# -------
# beta is the friction force over the force of the shaker.  With small friction the corner slides, with large
# friction it sticks permanently.  Near the resonances of the plate with the corner held, sticking needs more
# friction, because the load in the contact is larger.  The white peaks are at the resonances of the free
# plate.

ds = fm.sweep(plate, r, np.geomspace(0.02, 4.0, 60), outputs=["regime", "stops_per_cycle", "status"])
for ax in np.ravel(fm.plot_regimes(ds)):
    ax.set_yscale("log")
plt.show()

# %%
# The stated error applies to responses to loads in the range.  With 24 modes the boundary to permanent
# sticking is unchanged and the median change of the amplitudes is 0.4 %.  However, 9 % of the cells
# change from continuous motion to very short stops.  The reason is that a reversal of friction excites fast
# modes: with twelve modes the effective mass of the corner is 363 times the true one.  On a finer mesh the
# true effective mass of a point is smaller still, so the boundary of continuous motion depends on the
# model.
