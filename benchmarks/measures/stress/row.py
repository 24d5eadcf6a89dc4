"""40-digit results of one structure at one frequency: boundaries, regimes, continuous amplitudes."""

from dataclasses import dataclass

from frictionmap import regimes

from ...references import closed_forms
from ...references.closed_forms import Number, mp
from .bodies import Body
from .check_curves import stick_boundary
from .group import ROUNDING


@dataclass(frozen=True)
class Row:
    """40-digit results of one structure at one (r, mu)."""

    body: Body
    own: closed_forms.Structure
    r: float
    mu: float
    found: closed_forms.Functions
    lim: Number
    stick: Number
    slack: float  # relative distance to a boundary that the rounding of r makes

    @classmethod
    def of(cls, body: Body, r: float, mu: float = 1.0) -> "Row":
        """Compute them."""
        own = body.own
        found = closed_forms.functions(own, r)
        lim = closed_forms.beta_lim(own, r, mu, found)
        at = closed_forms.condition(
            lambda x: closed_forms.beta_lim(own, x, mu, closed_forms.functions(own, x, found.tau)), r
        )
        return cls(
            body,
            own,
            r,
            mu,
            found,
            lim,
            stick_boundary(own, r, mu),
            4.0 * ROUNDING * (1.0 + float(min(at, 1e20))),
        )

    def regime(self, beta: float) -> int | None:
        """Proved regime: for mu = 1 any, for mu > 1 (from rest, one mass) only sticking."""
        if mp.mpf(beta) >= self.stick:
            return regimes.PERMANENT_STICKING
        if self.mu > 1.0:
            return None
        return regimes.CONTINUOUS if mp.mpf(beta) < self.lim else regimes.STICK_SLIP

    def near(self, beta: float) -> bool:
        """Whether rounding can decide on which side of a boundary beta lies."""
        return any(
            abs(mp.mpf(beta) - edge) <= self.slack * abs(edge)
            for edge in (self.lim, self.stick)
            if mp.isfinite(edge)
        )

    def amplitude(self, beta: Number, r: Number = None) -> Number:
        """Z of the continuous motion."""
        found = self.found if r is None else closed_forms.functions(self.own, r, self.found.tau)
        return closed_forms.continuous_amplitude(found, beta)
