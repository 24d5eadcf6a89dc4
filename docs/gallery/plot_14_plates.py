"""
Plates: Leissa's table
======================

The edges of a rectangular plate can be clamped (C), simply supported (S) or free (F) in 21 ways. Leissa
(1973) tabulated the first six natural frequencies of all of them, by exact equations for the six sets with
two opposite supported edges, and by Ritz's method for the others. Here `fm.Plate` computes the table again,
for square plates with a Poisson's ratio of 0.3. Frequencies are over sqrt(D/(rho h))/a^2. The letters are
the edges x = 0, y = 0, x = a, y = a.
"""

import matplotlib.pyplot as plt
import numpy as np

import frictionmap as fm

LEISSA = {
    "SSSS": [19.7392, 49.3480, 49.3480, 78.9568, 98.6960, 98.6960],
    "SCSC": [28.9509, 54.7431, 69.3270, 94.5853, 102.2162, 129.0955],
    "SCSS": [23.6463, 51.6743, 58.6464, 86.1345, 100.2698, 113.2281],
    "SCSF": [12.6874, 33.0651, 41.7019, 63.0148, 72.3976, 90.6114],
    "SSSF": [11.6845, 27.7563, 41.1967, 59.0655, 61.8606, 90.2941],
    "SFSF": [9.6314, 16.1348, 36.7256, 38.9450, 46.7381, 70.7401],
    "CCCC": [35.992, 73.413, 73.413, 108.27, 131.64, 132.24],
    "CCCS": [31.829, 63.347, 71.084, 100.83, 116.40, 130.37],
    "CCCF": [24.020, 40.039, 63.493, 76.761, 80.713, 116.80],
    "CCSS": [27.056, 60.544, 60.791, 92.865, 114.57, 114.72],
    "CCSF": [17.615, 36.046, 52.065, 71.194, 74.349, 106.28],
    "CCFF": [6.9421, 24.034, 26.681, 47.785, 63.039, 65.833],
    "CSCF": [23.460, 35.612, 63.126, 66.808, 77.502, 108.99],
    "CSSF": [16.865, 31.138, 51.631, 64.043, 67.646, 101.21],
    "CSFF": [5.3639, 19.171, 24.768, 43.191, 53.000, 64.050],
    "CFCF": [22.272, 26.529, 43.664, 61.466, 67.549, 79.904],
    "CFSF": [15.285, 20.673, 39.775, 49.730, 56.617, 77.368],
    "CFFF": [3.4917, 8.5246, 21.429, 27.331, 31.111, 54.443],
    "SSFF": [3.3687, 17.407, 19.367, 38.291, 51.324, 53.738],
    "SFFF": [6.6480, 15.023, 25.492, 26.126, 48.711, 50.849],
    "FFFF": [13.489, 19.789, 24.432, 35.024, 35.024, 61.526],
}
WORDS = {"C": "clamped", "S": "supported", "F": "free"}
EXACT = list(LEISSA)[:6]


def plate(letters):
    """The plate with these edges x = 0, y = 0, x = a, y = a."""
    left, front, right, back = (WORDS[letter] for letter in letters)
    return fm.Plate(
        [left, right, front, back], [1.0, 1.0], bending_stiffness=1.0, mass_per_area=1.0, nu=0.3,
        points={"middle": [0.5, 0.5]}, modes=6,
    )  # fmt: skip


plates = {letters: plate(letters) for letters in LEISSA}
above = {letters: np.array(LEISSA[letters]) / one.frequencies - 1.0 for letters, one in plates.items()}

# %%
# The frequencies, and how much Leissa's are above them
# -----------------------------------------------------
# His exact values are reproduced to all digits. His other values are upper bounds, as those of every Ritz
# method, here too; with 36 functions they are up to 1 % higher. The last column is the change of the six
# frequencies of `fm.Plate` with fewer functions (`frequency_error`).

print("edges  frequencies over sqrt(D/(rho h))/a^2                      Leissa above by     own error")
for letters, one in plates.items():
    row = " ".join(f"{w:8.4f}" for w in one.frequencies)
    most = 100.0 * above[letters].max()
    print(f"{letters}   {row}   {most:6.3f} % at most   {one.frequency_error.max():.0e}")

fig, ax = plt.subplots(figsize=(9.0, 3.6), layout="constrained")
for place, (letters, excess) in enumerate(above.items()):
    exact = letters in EXACT
    ax.plot(
        np.full(6, place), 100.0 * excess, "o", color="black", markerfacecolor="black" if exact else "white"
    )
ax.plot([], [], "o", color="black", label="exact equations")
ax.plot([], [], "o", color="black", markerfacecolor="white", label="Ritz's method, 36 functions")
ax.axhline(0.0, color="0.6", linewidth=0.8, zorder=0.5)
ax.set_xticks(range(len(LEISSA)), LEISSA, rotation=60)
ax.set(xlabel="edges", ylabel="Leissa (1973) above fm.Plate [%]")
ax.legend()
plt.show()

# %%
# The first modes
# ---------------
# Thick edges are clamped, dashed ones supported, thin ones free.

EDGES = {"C": {"linewidth": 4.0}, "S": {"linestyle": (0, (3, 2))}, "F": {"linewidth": 0.6}}
fig, axes = plt.subplots(3, 7, figsize=(9.6, 4.8), layout="constrained")
side = np.linspace(0.0, 1.0, 61)
places = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
for ax, (letters, one) in zip(axes.ravel(), plates.items(), strict=True):
    shape = one.shapes_at(places)[:, 0].reshape(side.size, side.size)
    most = np.abs(shape).max()
    ax.pcolormesh(side, side, shape, cmap="RdBu_r", vmin=-most, vmax=most, shading="gouraud")
    ends = [([0, 0], [0, 1]), ([0, 1], [0, 0]), ([1, 1], [0, 1]), ([0, 1], [1, 1])]
    for letter, (x, y) in zip(letters, ends, strict=True):
        ax.plot(x, y, color="black", clip_on=False, **EDGES[letter])
    ax.set_title(f"{letters}  {one.frequencies[0]:.4g}", fontsize=9)
    ax.set_aspect("equal")
    ax.axis("off")
plt.show()
