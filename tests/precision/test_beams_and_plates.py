"""Beams against their cosh and sinh at 60 digits and more, plates against closed forms and Levy's."""

import itertools
import math
import re

import mpmath
import numpy as np
import pytest

from frictionmap.errors import InputError
from frictionmap.structures import beam, plate
from frictionmap.structures.uniform import Beam, Plate

#: Letters of the reference values.
WORDS = {"C": "clamped", "P": "pinned", "F": "free", "G": "guided", "S": "supported"}
PAIRS = list(itertools.product(beam.ENDS, repeat=2))
X = np.array([0.0, 0.1, 0.25, 0.5, 0.8, 1.0])


def exact_mode(ends, b):
    """The mode next to a root b as cosh, sinh, cos and sin, at 60 digits beyond what cosh b takes.

    Returns the root, and a function of x with the displacement of unit modal mass, of either sign.
    """
    mpmath.mp.dps = 60 + int(2.0 * b / math.log(10.0))

    def terms(x, order, root):
        cosh, sinh, cos, sin = (f(root * x) for f in (mpmath.cosh, mpmath.sinh, mpmath.cos, mpmath.sin))
        even = order % 2 == 0
        first = [cosh, sinh] if even else [sinh, cosh]
        last = ([cos, sin], [-sin, cos], [-cos, -sin], [sin, -cos])[order]
        return first + last

    def rows(root):
        found = [terms(mpmath.mpf(0), order, root) for order in beam.ENDS[ends[0]]]
        return mpmath.matrix(found + [terms(mpmath.mpf(1), order, root) for order in beam.ENDS[ends[1]]])

    low, high = mpmath.mpf(b) * (1 - mpmath.mpf(10) ** -9), mpmath.mpf(b) * (1 + mpmath.mpf(10) ** -9)
    root = mpmath.findroot(lambda at: mpmath.det(rows(at)), (low, high), solver="anderson", tol=1e-80)
    matrix = rows(root)
    for free in range(4):  # the amplitude that is 1; the others follow from three of the rows
        others = [k for k in range(4) if k != free]
        part = mpmath.matrix([[matrix[i, k] for k in others] for i in range(4)])
        normal = part.T * part
        if abs(mpmath.det(normal)) > mpmath.mpf(10) ** -20:
            break
    found = mpmath.lu_solve(normal, part.T * mpmath.matrix([-matrix[i, free] for i in range(4)]))
    amplitudes = [mpmath.mpf(1)] * 4
    for k, value in zip(others, found, strict=True):
        amplitudes[k] = value

    def place(x):
        return mpmath.fdot(amplitudes, terms(mpmath.mpf(x), 0, root))

    parts = max(8, int(b))
    square = mpmath.mpf(0)
    nodes = mpmath.linspace(0, 1, parts + 1)
    at, weights = np.polynomial.legendre.leggauss(24)
    for left, right in itertools.pairwise(nodes):
        for x, weight in zip(at, weights, strict=True):
            square += (
                weight * place(left + (right - left) * (1 + mpmath.mpf(x)) / 2) ** 2 * (right - left) / 2
            )
    return root, [float(place(x) / mpmath.sqrt(square)) for x in X]


@pytest.mark.parametrize(("pair", "mode"), [
    (("clamped", "free"), 1), (("clamped", "free"), 14), (("free", "free"), 3), (("pinned", "clamped"), 2),
    (("guided", "free"), 20), (("clamped", "clamped"), 40), (("free", "pinned"), 1),
])  # fmt: skip
def test_modes_at_many_digits(pair, mode):
    # Gauss's weights have 16 digits, which limit the norm to a few 1e-16
    ends = beam.Ends(*pair)
    b = beam.roots(ends, mode)
    root, expected = exact_mode(pair, float(b[-1]))
    assert abs(float(b[-1] / root - 1)) <= 3e-16
    found = beam.shapes(ends, b[-1:], X)[:, 0]
    sign = np.sign(found @ expected)
    np.testing.assert_allclose(found, sign * np.array(expected), rtol=0.0, atol=5e-14)


@pytest.mark.parametrize("pair", PAIRS)
def test_modes_up_to_200_are_orthonormal(pair):
    ends = beam.Ends(*pair)
    b = beam.roots(ends, 200)
    assert (np.abs(np.diff(b) - math.pi) < 0.35).all()  # none is missed
    nodes, weights = np.polynomial.legendre.leggauss(500)
    x = 0.5 * (1.0 + nodes)
    phi = np.hstack((beam.rigid_shapes(ends, x), beam.shapes(ends, b, x)))
    gram = (phi * (0.5 * weights)[:, np.newaxis]).T @ phi
    np.testing.assert_allclose(gram, np.eye(len(gram)), rtol=0.0, atol=2e-13)


@pytest.mark.parametrize("pair", PAIRS)
def test_compliance_is_the_sum_of_all_modes(pair):
    # beyond mode N the sum adds at most sum 4/b^4 < 4/(3 pi^4 N^3)
    ends = beam.Ends(*pair)
    b = beam.roots(ends, 200)
    phi = beam.shapes(ends, b, X)
    summed = (phi / b**4) @ phi.T
    found = beam.compliance(ends, X)
    assert np.abs(found - summed).max() <= 4.0 / (3.0 * math.pi**4 * 198.0**3) + 1e-15
    np.testing.assert_allclose(found, found.T, rtol=0.0, atol=1e-15)


def test_compliance_of_textbooks():
    tip = np.array([1.0])
    middle = np.array([0.5])
    assert beam.compliance(beam.Ends("clamped", "free"), tip)[0, 0] == pytest.approx(1 / 3, rel=1e-15)
    assert beam.compliance(beam.Ends("pinned", "pinned"), middle)[0, 0] == pytest.approx(1 / 48, rel=1e-14)
    assert beam.compliance(beam.Ends("clamped", "clamped"), middle)[0, 0] == pytest.approx(1 / 192, rel=1e-13)


def test_residual_of_a_free_end():
    # modes beyond N of a free end: sum of 4/b^4, b = (i - 1/2) pi to rounding
    found = Beam("clamped-free", length=1.0, bending_stiffness=1.0, mass_per_length=1.0, points={"tip": 1.0},
                 modes=8).residual[0, 0]  # fmt: skip
    exact = 4.0 * float(mpmath.zeta(4, 8.5)) / math.pi**4
    assert found == pytest.approx(exact, abs=3e-16)


def test_dimensions_of_a_beam():
    steel = Beam("clamped-free", length=0.3, E=2.1e11, width=0.02, height=0.005, density=7850.0,
                 points={"tip": 0.3, "shaker": 0.18}, modes=3)  # fmt: skip
    inertia, area = 0.02 * 0.005**3 / 12.0, 0.02 * 0.005
    expected = 1.8751040687119611**2 * math.sqrt(2.1e11 * inertia / (7850.0 * area)) / 0.3**2
    assert steel.frequencies[0] == pytest.approx(expected, rel=1e-14)
    assert steel.shapes[0] ** 2 * 7850.0 * area * 0.3 == pytest.approx([4.0] * 3, rel=1e-13)
    whole = steel.residual + (steel.shapes / steel.frequencies**2) @ steel.shapes.T
    assert whole[0, 0] == pytest.approx(0.3**3 / (3.0 * 2.1e11 * inertia), rel=1e-13)
    a = 0.18  # a force there bends the tip by a^2 (3 L - a)/(6 EI)
    assert whole[0, 1] == pytest.approx(a**2 * (0.9 - a) / (6.0 * 2.1e11 * inertia), rel=1e-13)


def is_root(ends, tips, b):
    """Whether a determinant at 60 digits has a zero within 1e-13 of b."""
    mpmath.mp.dps = 60

    def determinant(root):
        rows = []
        sides = zip((0, 1), ends, (1, -1), tips.springs, tips.masses, strict=True)
        for x, kind, sign, spring, mass in sides:
            cosh, sinh, cos, sin = (f(root * x) for f in (mpmath.cosh, mpmath.sinh, mpmath.cos, mpmath.sin))
            place = [cosh, sinh, cos, sin]
            slopes = [place, [sinh, cosh, -sin, cos], [cosh, sinh, -cos, -sin], [sinh, cosh, sin, -cos]]
            for order in beam.ENDS[kind]:
                share = sign * (spring / root**3 - mass * root) if order == 3 else 0
                rows.append([a + share * c for a, c in zip(slopes[order], place, strict=True)])
        return mpmath.sign(mpmath.det(mpmath.matrix(rows)))

    b, near = mpmath.mpf(float(b)), mpmath.mpf(10) ** -13
    return determinant(b * (1 - near)) != determinant(b * (1 + near))


@pytest.mark.parametrize(("pair", "tips"), [
    (("clamped", "free"), beam.Tips((0.0, 0.0), (0.0, 1.0))),
    (("clamped", "free"), beam.Tips((0.0, 5.0), (0.0, 0.3))),
    (("free", "free"), beam.Tips((2.0, 30.0), (0.5, 0.0))),
    (("pinned", "free"), beam.Tips((0.0, 0.01), (0.0, 100.0))),
    (("guided", "guided"), beam.Tips((1.0, 0.0), (0.0, 2.0))),
])  # fmt: skip
def test_springs_and_masses_at_the_ends(pair, tips):
    ends = beam.Ends(*pair)
    b = beam.roots_with_tips(ends, tips, 40)
    assert all(is_root(ends, tips, one) for one in b[[0, 1, 2, 5, 11]])
    assert (np.diff(b[3:]) < 1.5 * math.pi).all()  # none is missed
    nodes, weights = np.polynomial.legendre.leggauss(200)
    phi = beam.shapes(ends, b, 0.5 * (1.0 + nodes), tips)
    gram = (phi * (0.5 * weights)[:, np.newaxis]).T @ phi
    for place, mass in zip((0.0, 1.0), tips.masses, strict=True):
        at_end = beam.shapes(ends, b, np.array([place]), tips)
        gram += mass * at_end.T @ at_end
    np.testing.assert_allclose(gram, np.eye(len(b)), rtol=0.0, atol=1e-12)
    parts = beam.shapes(ends, b, X, tips) / b**2
    # beyond mode 40 the sum adds at most sum 4/b^4
    within = 4.0 / (3.0 * math.pi**4 * 36.0**3)
    assert np.abs(beam.compliance(ends, X, tips) - parts @ parts.T).max() <= within


def test_a_tip_mass_of_a_textbook():
    # a cantilever with its own mass at the tip: 1.2479 (Blevins, Formulas for Natural Frequency)
    one = Beam("clamped-free", length=2.0, bending_stiffness=3.0, mass_per_length=0.5, points={"tip": 2.0},
               end_masses=[0.0, 1.0], end_springs=[0.0, 0.0])  # fmt: skip
    assert math.sqrt(one.frequencies[0] * 4.0 / math.sqrt(6.0)) == pytest.approx(1.2479, abs=5e-5)
    whole = one.residual + (one.shapes / one.frequencies**2) @ one.shapes.T
    assert whole[0, 0] == pytest.approx(8.0 / 9.0, rel=1e-13)  # masses do not bend it at rest
    sprung = Beam("clamped-free", length=2.0, bending_stiffness=3.0, mass_per_length=0.5, points={"tip": 2.0},
                  end_springs=[0.0, 0.7])  # fmt: skip
    whole = sprung.residual + (sprung.shapes / sprung.frequencies**2) @ sprung.shapes.T
    assert whole[0, 0] == pytest.approx(1.0 / (9.0 / 8.0 + 0.7), rel=1e-13)


def test_supported_plate_is_navier_s():
    edges = plate.Edges(*["supported"] * 4)
    found = plate.solve_plate(edges, 1.5, 0.3, 16)
    squares = sorted(math.pi**2 * (m**2 + (n / 1.5) ** 2) for m in range(1, 5) for n in range(1, 7))
    np.testing.assert_allclose(found.w[:6], squares[:6], rtol=1e-12)
    points = np.array([[0.5, 0.75], [0.3, 0.4]])
    shape = 2.0 / math.sqrt(1.5) * np.sin(math.pi * points[:, 0]) * np.sin(math.pi * points[:, 1] / 1.5)
    np.testing.assert_allclose(np.abs(found.shapes(points, 1)[:, 0]), shape, rtol=1e-11)
    m, n = np.meshgrid(np.arange(1, 2001), np.arange(1, 2001))
    waves = [np.sin(m * math.pi * x) * np.sin(n * math.pi * y / 1.5) for x, y in points]
    mode = math.pi**4 * (m**2 + (n / 1.5) ** 2) ** 2
    double = 4.0 / 1.5 * np.sum(waves[0] * waves[1] / mode)
    single = plate.supported_compliance(points, 1.5)
    assert single[0, 1] == pytest.approx(double, rel=1e-8)
    # coefficient of the deflection under a central load, Timoshenko and Woinowsky-Krieger, table 23
    square = plate.supported_compliance(np.array([[0.5, 0.5]]), 1.0)
    assert square[0, 0] == pytest.approx(0.01160, abs=5e-6)


def levy(first, last, b, nu, omega):
    """Smallest determinant over m of a plate with the edges x = 0, 1 supported, at 40 digits, with signs."""
    mpmath.mp.dps = 40

    def determinant(m):
        alpha = m * mpmath.pi
        roots = [mpmath.sqrt(alpha**2 + omega), mpmath.sqrt(mpmath.mpc(alpha**2 - omega))]
        rates = [roots[0], -roots[0], roots[1], -roots[1]]
        rows = []
        for at, kind in ((mpmath.mpf(0), first), (mpmath.mpf(b), last)):
            waves = [mpmath.exp(rate * at) for rate in rates]
            if kind == "free":
                rows.append([w * (s**2 - nu * alpha**2) for w, s in zip(waves, rates, strict=True)])
                rows.append([w * (s**3 - (2 - nu) * alpha**2 * s) for w, s in zip(waves, rates, strict=True)])
                continue
            rows.append(waves)
            order = 1 if kind == "clamped" else 2
            rows.append([w * s**order for w, s in zip(waves, rates, strict=True)])
        value = mpmath.det(mpmath.matrix(rows)) / (roots[0] * roots[1])  # real
        return value.real if abs(value.real) >= abs(value.imag) else value.imag

    return [mpmath.sign(determinant(m)) for m in range(1, 5)]


@pytest.mark.parametrize(("first", "last", "b", "number"), [
    ("clamped", "clamped", 1.0, 6), ("clamped", "free", 1.5, 6), ("free", "free", 1.0, 6),
    ("supported", "free", 0.7, 4),
])  # fmt: skip
def test_levy_s_plates(first, last, b, number):
    # a frequency is a zero of one of the determinants: it changes sign within 2e-12 of the computed one
    found = plate.solve_plate(plate.Edges("supported", "supported", first, last), b, 0.3, 20)
    for w in found.w[:number]:
        below = levy(first, last, b, mpmath.mpf("0.3"), mpmath.mpf(float(w)) * (1 - mpmath.mpf("2e-12")))
        above = levy(first, last, b, mpmath.mpf("0.3"), mpmath.mpf(float(w)) * (1 + mpmath.mpf("2e-12")))
        assert below != above


def test_leissa_s_plates():
    # upper bounds by Leissa (J. Sound Vib. 31, 1973), square plates, nu = 0.3
    known = {
        "CCCC": [35.992], "CFFF": [3.4917, 8.5246], "FFFF": [13.489, 19.789, 24.432], "SFSF": [9.6314],
        "SCSC": [28.9509],
    }  # fmt: skip
    for letters, bounds in known.items():
        left, front, right, back = (WORDS[letter] for letter in letters)
        found = plate.solve_plate(plate.Edges(left, right, front, back), 1.0, 0.3, 14)
        elastic = found.w[found.rigid : found.rigid + len(bounds)]
        assert (elastic <= np.array(bounds) * (1.0 + 1e-5)).all()
        assert (elastic >= np.array(bounds) * 0.985).all()


def test_a_plate_between_rollers_is_a_beam():
    # edges y = 0, b free and nu = 0: a strip bends as a beam, and so its shapes and its compliance along x
    strip = Plate(["clamped", "free", "free", "free"], [1.0, 0.1], bending_stiffness=1.0, mass_per_area=1.0,
                  nu=0.0, points={"tip": [1.0, 0.05]}, modes=2)  # fmt: skip
    one = Beam("clamped-free", length=1.0, bending_stiffness=0.1, mass_per_length=0.1, points={"tip": 1.0},
               modes=2)  # fmt: skip
    assert strip.frequencies[0] == pytest.approx(one.frequencies[0], rel=1e-9)
    assert abs(strip.shapes[0, 0]) == pytest.approx(one.shapes[0, 0], rel=1e-9)


@pytest.mark.parametrize(("kind", "given", "message"), [
    (Beam, {"ends": "clamped-loose"}, "ends must be two of clamped, pinned, free, guided"),
    (Beam, {"points": {"tip": 1.2}},
     "points.tip must be on the beam, 0 to 1 (in m, or as you give lengths); got 1.2"),
    (Beam, {"points": {"root": 0.0}}, "points.root must move: the clamped-free beam is at rest there; got 0"),
    (Beam, {"modes": 500}, "modes must be <= 198; got 500"),
    (Beam, {"E": 1.0}, "cannot use E with bending_stiffness"),
    (Beam, {"end_masses": [1.0, 0.0]}, r"end_masses[0] must be 0 at a clamped end, which is at rest; got 1"),
    (Beam, {"ends": "free-free", "end_springs": [1.0, 0.0]}, "end_springs must leave no rigid-body mode"),
    (Beam, {"end_masses": [0.0, 1e12], "ends": "pinned-free", "end_springs": [0.0, 1.0]},
     "end_masses must leave the first root b"),
    (Plate, {"points": {"p": [0.0, 0.5]}}, "points.p must move: the edge x = 0 is clamped"),
    (Plate, {"points": {"p": [0.5, 1.5]}},
     "points.p must be on the plate, y from 0 to 1 (in m, or as you give lengths); got 1.5"),
    (Plate, {"edges": ["clamped"]}, "edges must be four of clamped, supported, free"),
])  # fmt: skip
def test_refusals(kind, given, message):
    whole = {
        Beam: {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0, "points": {"tip": 1.0}},
        Plate: {
            "size": [1.0, 1.0],
            "bending_stiffness": 1.0,
            "mass_per_area": 1.0,
            "points": {"p": [1.0, 1.0]},
        },
    }[kind]
    with pytest.raises(InputError, match=re.escape(message)):
        kind(**{**whole, **given})


def test_reference_beams(reference_table):
    rows = [row for row in reference_table("continuous.json")["rows"] if row["kind"] == "beam"]
    for row in rows:
        ends = beam.Ends(*(WORDS[letter] for letter in row["given"]["ends"]))
        x, modes = np.array(row["given"]["x"]), np.array(row["given"]["mode_numbers_elastic"])
        expected, within = row["expect"], row["tolerance"]
        b = beam.roots(ends, int(modes.max()))
        rigid = len(beam.rigid_lines(ends))
        assert rigid == expected["rigid_modes"]
        np.testing.assert_allclose(b[modes - 1], expected["root"], rtol=within["root"])
        found = beam.shapes(ends, b[modes - 1], x).T
        np.testing.assert_allclose(found, expected["shape"], rtol=0.0, atol=within["shape"])
        whole = beam.compliance(ends, x)
        np.testing.assert_allclose(whole, expected["compliance"], rtol=0.0, atol=within["compliance"])
        eight = b[: 8 - rigid]
        phi = beam.shapes(ends, eight, x)
        rest = whole - (phi / eight**4) @ phi.T
        np.testing.assert_allclose(rest, expected["residual_8_modes"], rtol=0.0, atol=within["residual"])


def test_reference_plates(reference_table):
    rows = [row for row in reference_table("continuous.json")["rows"] if row["kind"] == "plate"]
    for row in rows:
        given, expected, within = row["given"], row["expect"], row["tolerance"]
        points = expected.get("compliance_points", [[0.5 * given["a"], 0.5 * given["b"]]])
        found = Plate(
            [WORDS[letter] for letter in given["edges"]], [given["a"], given["b"]], bending_stiffness=1.0,
            mass_per_area=1.0, nu=given["nu"], points={str(k): one for k, one in enumerate(points)}, modes=6,
        )  # fmt: skip
        assert found.solution.rigid == expected["rigid_modes"]
        np.testing.assert_allclose(found.frequencies, expected["omega"], rtol=within["omega"])
        if "compliance" in expected:
            whole = found.residual + (found.shapes / found.frequencies**2) @ found.shapes.T
            np.testing.assert_allclose(whole.ravel(), expected["compliance"], atol=within["compliance"])
            square = found.shapes[:, 0] ** 2
            np.testing.assert_allclose(
                square, expected["shape_squared_mode1"], rtol=within["shape_squared_mode1"]
            )
