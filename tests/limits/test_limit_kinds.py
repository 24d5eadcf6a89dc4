"""What ends the motion without stops, against the equations of that motion (theory.md 11).

The motion is the sum of the response to the load and of those to square waves of friction that turn with
each contact; the phases of the turns solve z_i'(tau_i) = 0.
"""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import fsolve

import frictionmap as fm

TURN, INSIDE, COINCIDENCE, UNLOADED = 1, 2, 3, 4


class Waves:
    """Motions of two unit masses with a unit force that changes its sign every half period, mode by mode."""

    def __init__(self, stiffness, zeta, r, w):
        squares, phi = eigh(stiffness)
        self.chi, self.w, self.r = w.T @ phi, np.sqrt(squares), r
        self.zeta, self.load = zeta, phi[0]  # on mass 1
        self.rates = [np.array([[0.0, 1.0], [-((s / r) ** 2), -2.0 * zeta * s / r]]) for s in self.w]
        self.begins = []
        for m, a in enumerate(self.rates):  # y(pi) = -y(0) under the force +1/r^2
            rest = np.linalg.solve(a, [0.0, -1.0 / r**2])
            e = self.flow(m, np.pi)
            self.begins.append((rest, np.linalg.solve(e + np.eye(2), (e - np.eye(2)) @ rest)))

    def flow(self, m, tau):
        """exp(tau a) of a mode, a its matrix of rates."""
        decay, turn = self.zeta * self.w[m] / self.r, np.sqrt(1.0 - self.zeta**2) * self.w[m] / self.r
        shifted = self.rates[m] + decay * np.eye(2)
        return np.exp(-decay * tau) * (np.cos(turn * tau) * np.eye(2) + np.sin(turn * tau) / turn * shifted)

    def square(self, m, tau):
        """Displacement, velocity, acceleration of mode m: force +1 in (0, pi), -1 in (pi, 2 pi)."""
        turns = np.floor(tau / np.pi)
        sign, rest = 1.0 - 2.0 * np.mod(turns, 2.0), tau - np.pi * turns
        equilibrium, begin = self.begins[m]
        y = equilibrium + self.flow(m, rest) @ (begin - equilibrium)
        return sign * np.array([*y, (self.rates[m] @ y)[1] + 1.0 / self.r**2])

    def contact(self, i, tau, beta, turns):
        """z_i and its derivatives; friction on contact j is +beta_j, against a fall, from its maximum on."""
        found = np.zeros(3)
        for m, w in enumerate(self.w):
            q = self.load[m] / (w**2 - self.r**2 + 2j * self.zeta * w * self.r) * np.exp(1j * tau)
            mode = np.array([q.real, (1j * q).real, (-q).real])
            for j, turn in enumerate(turns):
                mode += beta[j] * self.chi[j, m] * self.square(m, tau - turn)
            found += self.chi[i, m] * mode
        return found

    def margins(self, ray, scale):
        """Turns, least margin at a turn, least speed between turns; both with the contact they are of."""
        phasors = (self.load / (self.w**2 - self.r**2 + 2j * self.zeta * self.w * self.r)) @ self.chi.T
        turns = -np.angle(phasors)
        for s in np.linspace(0.0, scale, 41)[1:]:
            turns = fsolve(
                lambda t, s=s: [self.contact(i, t[i] - 1e-13, s * ray, t)[1] for i in range(len(ray))],
                turns, xtol=1e-12, full_output=True,
            )[0]  # fmt: skip
        own = ((self.chi / self.r) ** 2).sum(axis=1)
        at_turn, inside = (np.inf, 0), (np.inf, 0)
        for i, turn in enumerate(turns):
            bend = -self.contact(i, turn - 1e-10, scale * ray, turns)[2]
            at_turn = min(at_turn, (bend / (2.0 * scale * ray[i] * own[i]) - 1.0, i + 1))
            kinks = np.mod(turns - turn, np.pi)
            times = np.unique(np.concatenate((np.linspace(0.02, np.pi - 0.02, 400), kinks)))
            times = times[(times > 0.01) & (times < np.pi - 0.01)]
            for _ in range(3):
                speeds = [-self.contact(i, turn + t, scale * ray, turns)[1] for t in times]
                inside, slowest = min(inside, (min(speeds), i + 1)), times[np.argmin(speeds)]
                near = 2.0 * np.diff(times).max()
                times = np.linspace(max(0.01, slowest - near), min(np.pi - 0.01, slowest + near), 101)
        return turns, at_turn, inside


W = np.array([[1.0, -1.0], [0.0, 1.0]])
K = np.array([[2.0, -1.0], [-1.0, 1.0]])


def system_of(second, zeta=0.01):
    contacts = [fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2), ratio=second)]
    return fm.System(
        contacts=contacts, mass_ratios=[1.0, 1.0], stiffness_ratios=[1.0, 1.0], damping_ratios=zeta
    )


@pytest.mark.parametrize(
    ("r", "second", "kind"),
    [
        (0.5, 0.3, INSIDE), (0.9, 0.3, TURN), (1.3, 0.3, TURN), (0.5, 1.0, TURN), (0.5, 0.45, INSIDE),
        (0.2625, 0.3, COINCIDENCE), (0.25, 0.5, COINCIDENCE), (0.255, 0.6, COINCIDENCE),
    ],
)  # fmt: skip
def test_kinds_are_those_of_the_equations(r, second, kind):
    """The margin of its kind, and no other, is zero at beta_lim; at a coincidence one jumps across zero."""
    ds = fm.boundaries(system_of(second), [r])
    assert ds.limit_kind.item() == kind
    waves, ray = Waves(K, 0.01, r, W), np.array([1.0, second])
    limit = ds.beta_lim.item()
    below, above = (waves.margins(ray, limit * (1.0 + side)) for side in (-1e-7, 1e-7))
    turns, (at_turn, turning), (inside, touching) = below
    contact = {TURN: turning, INSIDE: touching, COINCIDENCE: above[1][1]}[kind]
    assert ds.limiting_contact.item() == contact
    if kind == TURN:
        assert -1e-9 < at_turn < 1e-6
        assert above[1][0] < 0.0
    elif kind == INSIDE:
        assert -1e-9 < inside < 1e-6
        assert above[2][0] < 0.0
        assert at_turn > 1e-3
    else:
        assert abs(turns[0] - turns[1]) < 1e-6
        assert at_turn > 0.1
        assert above[1][0] < -0.01
        assert inside > 1e-5


def test_a_larger_static_friction_makes_turns_limit():
    """mu multiplies what a turn needs: (2) with 1 + mu in the place of 2."""
    ds = fm.boundaries(system_of(0.3), [0.9], [1.0, 1.5])
    assert ds.limit_kind.values.ravel().tolist() == [TURN, TURN]
    waves, ray = Waves(K, 0.01, 0.9, W), np.array([1.0, 0.3])
    _, (at_turn, _), _ = waves.margins(ray, ds.beta_lim.values[1, 0])
    assert at_turn == pytest.approx(0.25, abs=1e-7)  # (1 + 1.5)/2 - 1


def test_a_contact_without_load():
    """Equal masses under equal loads: nothing moves between them."""
    system = fm.System(
        matrices={"M": np.eye(2), "K": np.array([[1.5, -0.5], [-0.5, 1.5]])}, load=[1.0, 1.0],
        damping_ratios=0.02, frequency_scale=1.0,
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("between-masses", (1, 2))],
    )  # fmt: skip
    ds = fm.boundaries(system, [0.7])
    assert ds.beta_lim.item() == 0.0
    assert (ds.limit_kind.item(), ds.limiting_contact.item()) == (UNLOADED, 2)
    assert ds.limit_kind.attrs["flag_meanings"] == "no_limit turn inside coincidence unloaded"
