"""Chains on a shaken base with one friction contact between the base and a mass: motions under a record.

The base acceleration is piecewise linear.  Solvers with events switch between two linear motions, sliding and
held, and begin anew at every sample, because the slope of the load jumps there.
"""

import os
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version

import numpy as np

from .body import SLIDE_END

#: Standard acceleration of gravity [m/s^2].
GRAVITY = 9.80665


@dataclass(frozen=True)
class Shaken:
    """A chain on a shaken base; matrices over mass 1, friction over m_1."""

    stiffness: np.ndarray  # K, diagonal masses are 1
    damping: np.ndarray
    contact: int  # the mass that rubs on the base
    friction: float
    acceleration: np.ndarray  # of the base, at the samples
    step: float  # between two samples

    @property
    def n(self) -> int:
        """Number of masses."""
        return len(self.stiffness)


class ShakenPeer:
    """A solver, made for one chain; `run` returns displacements of the masses at all samples, (n, samples).

    It raises RuntimeError if the solver fails.
    """

    name = ""
    package = ""
    setting = ""  # what is varied

    def __init__(self, body: Shaken, value: float) -> None:
        self.body, self.value = body, value

    def run(self) -> np.ndarray:
        """Follow the whole record from rest."""
        raise NotImplementedError

    @classmethod
    def why_missing(cls) -> str:
        """Return why this solver cannot run here, or "" if it can."""
        try:
            import_module(cls.package)
        except (ImportError, RuntimeError) as error:  # openseespy: RuntimeError without a BLAS library
            return f"{cls.package} cannot be imported ({error})"
        return ""

    @classmethod
    def version(cls) -> str:
        """Version of the package behind this peer."""
        return version(cls.package.partition(".")[0])


class SwitchingShaken(ShakenPeer):
    """Slides and stops of the contact in turn; a subclass integrates one phase within a sample."""

    def run(self) -> np.ndarray:
        """Follow the whole record from rest."""
        body = self.body
        found = np.zeros((body.n, body.acceleration.size))
        self.state = np.zeros(2 * body.n)
        self.sense = 0
        for k, (first, last) in enumerate(zip(body.acceleration, body.acceleration[1:], strict=False)):
            self._sample(float(first), float(last - first) / body.step)
            found[:, k + 1] = self.state[: body.n]
        return found

    def _sample(self, value: float, slope: float) -> None:
        """Follow the motion from one sample to the next."""
        time = 0.0
        while time < self.body.step:
            if self.sense == 0 and abs(force := self._held_force(value + slope * time)) > self.body.friction:
                self.sense = 1 if force > 0.0 else -1
            time, ended, sense = self._phase(time, value, slope)
            if not ended:
                return
            if self.sense:  # a slide ended: held, unless the force is too large
                self.state[self.body.n + self.body.contact] = 0.0
                self.sense = 0
            else:
                self.sense = sense

    def _held_force(self, acceleration: float) -> float:
        """Force on the contact that holds its mass."""
        n, j = self.body.n, self.body.contact
        pull = self.body.stiffness[j] @ self.state[:n] + self.body.damping[j] @ self.state[n:]
        return -float(pull) - acceleration

    def _phase(self, time: float, value: float, slope: float) -> tuple[float, bool, int]:
        """Integrate to an event or the sample's end: time, whether an event ended it, sense of a release."""
        raise NotImplementedError


def flow(body: Shaken, held: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Linear motion y' = A y + b a(t) + c f of state (x, v), a of the base, f the friction on the contact."""
    n, j = body.n, body.contact
    matrix = np.zeros((2 * n, 2 * n))
    matrix[:n, n:] = np.eye(n)
    matrix[n:] = np.hstack((-body.stiffness, -body.damping))
    load, rub = np.zeros(2 * n), np.zeros(2 * n)
    load[n:], rub[n + j] = -1.0, -1.0
    if held:
        matrix[j] = matrix[n + j] = 0.0
        load[n + j] = rub[n + j] = 0.0
    return matrix, load, rub


class ScipyShaken(SwitchingShaken):
    """scipy.integrate.solve_ivp, DOP853 with terminal events."""

    name = "solve_ivp DOP853"
    package = "scipy"
    setting = "rtol"

    def __init__(self, body: Shaken, value: float) -> None:
        super().__init__(body, value)
        self.solve = import_module("scipy.integrate").solve_ivp
        self.motions = {False: flow(body, False), True: flow(body, True)}

    def _events(self, value: float, slope: float) -> list:
        body, n, j = self.body, self.body.n, self.body.contact
        row = np.concatenate((-body.stiffness[j], -body.damping[j]))
        if self.sense:
            sense = self.sense

            def velocity(_time, y):
                return sense * y[n + j] - SLIDE_END

            events, directions = [velocity], [-1]
        else:

            def above(time, y):
                return row @ y - (value + slope * time) - body.friction

            def below(time, y):
                return row @ y - (value + slope * time) + body.friction

            events, directions = [above, below], [1, -1]
        for event, direction in zip(events, directions, strict=True):
            event.terminal, event.direction = True, direction
        return events

    def _phase(self, time: float, value: float, slope: float) -> tuple[float, bool, int]:
        matrix, load, rub = self.motions[self.sense == 0]
        constant = rub * (self.sense * self.body.friction) + load * value
        ramp = load * slope

        def rate(t, y):
            return matrix @ y + (constant + ramp * t)

        answer = self.solve(
            rate, (time, self.body.step), self.state, method="DOP853",
            rtol=self.value, atol=1e-3 * self.value, events=self._events(value, slope),
        )  # fmt: skip
        if answer.status < 0:
            raise RuntimeError(f"solve_ivp: {answer.message}")
        self.state = answer.y[:, -1].copy()
        released = 1 if answer.t_events[0].size else -1
        return float(answer.t[-1]), answer.status == 1, released


class ScipyThrough(ShakenPeer):
    """The same, but each slide and stop in one call through its samples, with steps of one sample at most.

    This is how records are usually given to such a solver: its steps do not end at the samples, where the
    slope of the load jumps.
    """

    name = "solve_ivp DOP853, through samples"
    package = "scipy"
    setting = "rtol"

    def run(self) -> np.ndarray:
        """Follow the whole record from rest."""
        body, n = self.body, self.body.n
        solve = import_module("scipy.integrate").solve_ivp
        times = np.arange(body.acceleration.size) * body.step
        found = np.zeros((n, times.size))
        state, time, sense, kept = np.zeros(2 * n), 0.0, 0, 1
        while kept < times.size:
            if sense == 0 and abs(force := self._force(time, state)) > body.friction:
                sense = 1 if force > 0.0 else -1
            answer = solve(
                self._rate(sense), (time, times[-1]), state, method="DOP853", dense_output=True,
                max_step=body.step, rtol=self.value, atol=1e-3 * self.value, events=self._events(sense),
            )  # fmt: skip
            if answer.status < 0:
                raise RuntimeError(f"solve_ivp: {answer.message}")
            time, state = float(answer.t[-1]), answer.y[:, -1].copy()
            last = int(np.searchsorted(times, time, side="right")) if answer.status == 1 else times.size
            if last > kept:  # else it ended before the next sample
                found[:, kept:last] = answer.sol(times[kept:last])[:n]
                kept = last
            if sense:
                state[n + body.contact] = 0.0
                sense = 0
            elif answer.status == 1:
                sense = 1 if answer.t_events[0].size else -1
        return found

    def _load(self, time: float) -> float:
        values, at = self.body.acceleration, time / self.body.step
        k = min(int(at), values.size - 2)
        return float(values[k] + (at - k) * (values[k + 1] - values[k]))

    def _force(self, time: float, state: np.ndarray) -> float:
        j = self.body.contact
        row = np.concatenate((self.body.stiffness[j], self.body.damping[j]))
        return -float(row @ state) - self._load(time)

    def _rate(self, sense: int):
        matrix, load, rub = flow(self.body, sense == 0)
        constant = rub * (sense * self.body.friction)

        def rate(time, y):
            return matrix @ y + (constant + load * self._load(time))

        return rate

    def _events(self, sense: int) -> list:
        row = self.body.n + self.body.contact
        if sense:
            events = [(lambda _time, y: sense * y[row] - SLIDE_END, -1)]
        else:
            limit = self.body.friction
            events = [
                (lambda time, y: self._force(time, y) - limit, 1),
                (lambda time, y: self._force(time, y) + limit, -1),
            ]
        for event, direction in events:
            event.terminal, event.direction = True, direction
        return [event for event, _ in events]


class HeyokaShaken(SwitchingShaken):
    """heyoka's Taylor integrator with terminal events: one program for slides, one for stops."""

    name = "heyoka"
    package = "heyoka"
    setting = "tol"

    def __init__(self, body: Shaken, value: float) -> None:
        super().__init__(body, value)
        heyoka = import_module("heyoka")
        n, j = body.n, body.contact
        x, v = heyoka.make_vars(*(f"x{k}" for k in range(n))), heyoka.make_vars(*(f"v{k}" for k in range(n)))
        x, v = ([x], [v]) if n == 1 else (x, v)
        base = heyoka.par[0] + heyoka.par[1] * heyoka.time
        pull = [
            -sum(body.stiffness[i, k] * x[k] + body.damping[i, k] * v[k] for k in range(n)) - base
            for i in range(n)
        ]
        sense = heyoka.par[2]
        free = [(x[k], v[k]) for k in range(n)] + [
            (v[i], pull[i] - (sense * body.friction if i == j else 0.0)) for i in range(n)
        ]
        # `+ 0.0 * x` keeps a right-hand side an expression
        stuck = [(x[k], v[k] if k != j else 0.0 * x[k]) for k in range(n)] + [
            (v[i], pull[i] if i != j else 0.0 * x[i]) for i in range(n)
        ]
        down, up = heyoka.event_direction.negative, heyoka.event_direction.positive
        options = {"tol": value}
        self.slider = heyoka.taylor_adaptive(
            free, [0.0] * (2 * n),
            t_events=[heyoka.t_event(sense * v[j] - SLIDE_END, direction=down, cooldown=0.0)], **options,
        )  # fmt: skip
        releases = [
            heyoka.t_event(pull[j] - body.friction, direction=up, cooldown=0.0),
            heyoka.t_event(pull[j] + body.friction, direction=down, cooldown=0.0),
        ]
        self.sticker = heyoka.taylor_adaptive(stuck, [0.0] * (2 * n), t_events=releases, **options)
        self.limit = heyoka.taylor_outcome.time_limit

    def _phase(self, time: float, value: float, slope: float) -> tuple[float, bool, int]:
        integrator = self.slider if self.sense else self.sticker
        numbers = value, slope, float(self.sense)
        integrator.pars[:] = numbers[: len(integrator.pars)]  # a stop has no sense
        integrator.state[:] = self.state
        integrator.time = time
        integrator.reset_cooldowns()
        outcome = integrator.propagate_until(self.body.step)[0]
        self.state = integrator.state.copy()
        return integrator.time, outcome != self.limit, (1 if int(outcome) == -1 else -1)


class OpenSees(ShakenPeer):
    """OpenSeesPy: Newmark's method, the contact an elastic, perfectly plastic spring of stiffness kt/k_1.

    The step is that of the record over `value`.  A step whose Newton iterations do not converge is done again
    with the initial stiffness.
    """

    name = "OpenSeesPy"
    package = "openseespy.opensees"
    setting = "steps per sample"

    def __init__(self, body: Shaken, value: float, kt: float = 30.0) -> None:
        super().__init__(body, value)
        self.kt, self.repeated = kt, 0
        self.ops = import_module("openseespy.opensees")
        self.ops.logFile(os.devnull, "-noEcho")  # its warnings on steps that are repeated

    def _model(self) -> None:
        """Masses on a line, springs, dashpots, the contact, the record."""
        ops, body = self.ops, self.body
        ops.wipe()
        ops.model("basic", "-ndm", 1, "-ndf", 1)
        for k in range(body.n + 1):
            ops.node(k, 0.0)
            if k:
                ops.mass(k, 1.0)
        ops.fix(0, 1)
        for i in range(body.n):
            for k in range(i, body.n):
                matrices = (body.stiffness, body.damping)
                stiffness, damping = (-m[i, k] if k > i else m[i].sum() for m in matrices)
                ends = (i + 1, k + 1) if k > i else (0, i + 1)
                if stiffness == damping == 0.0:
                    continue
                tag = 1 + 2 * (i * body.n + k)
                ops.uniaxialMaterial("Elastic", tag, float(stiffness))
                ops.uniaxialMaterial("Viscous", tag + 1, float(damping), 1.0)
                ops.element("zeroLength", tag, *ends, "-mat", tag, tag + 1, "-dir", 1, 1)
        tag = 1000
        stiffness = self.kt * float(body.stiffness[0].sum())
        ops.uniaxialMaterial("ElasticPP", tag, stiffness, body.friction / stiffness)
        ops.element("zeroLength", tag, 0, body.contact + 1, "-mat", tag, "-dir", 1)
        ops.timeSeries("Path", 1, "-dt", body.step, "-values", *body.acceleration.tolist())
        ops.pattern("UniformExcitation", 1, 1, "-accel", 1)

    def run(self) -> np.ndarray:
        """Follow the whole record from rest."""
        self._model()
        ops, body, parts = self.ops, self.body, int(self.value)
        for name, *settings in (
            ("constraints", "Plain"), ("numberer", "Plain"), ("system", "FullGeneral"),
            ("test", "NormDispIncr", 1e-12, 20, 0), ("algorithm", "Newton"),
            ("integrator", "Newmark", 0.5, 0.25), ("analysis", "Transient", "-noWarnings"),
        ):  # fmt: skip
            getattr(ops, name)(*settings)
        found = np.zeros((body.n, body.acceleration.size))
        self.repeated = 0
        for k in range(1, body.acceleration.size):
            for _ in range(parts):
                if ops.analyze(1, body.step / parts):
                    self._repeated(body.step / parts)
            found[:, k] = [ops.nodeDisp(i + 1, 1) for i in range(body.n)]
        return found

    def _repeated(self, step: float) -> None:
        """Do a step again with the initial stiffness."""
        ops = self.ops
        self.repeated += 1
        ops.algorithm("ModifiedNewton", "-initial")
        ops.test("NormDispIncr", 1e-12, 5000, 0)
        if ops.analyze(1, step):
            raise RuntimeError("OpenSees: a step did not converge")
        ops.algorithm("Newton")
        ops.test("NormDispIncr", 1e-12, 20, 0)


class OpenSeesBearing(OpenSees):
    """OpenSees's element singleFPBearing: one mass on a sliding pendulum bearing.

    Its radius makes the spring, and its initial stiffness that of spring and contact.
    """

    def __init__(self, body: Shaken, value: float, kt: float) -> None:
        super().__init__(body, value, kt)
        if body.n != 1:
            raise RuntimeError("the bearing carries one mass")

    def _model(self) -> None:
        """Build the mass on the bearing, under its weight; the radius makes the stiffness."""
        ops, body = self.ops, self.body
        weight = GRAVITY
        ops.wipe()
        ops.model("basic", "-ndm", 2, "-ndf", 3)
        ops.node(0, 0.0, 0.0)
        ops.node(1, 0.0, 0.0)
        ops.fix(0, 1, 1, 1)
        ops.fix(1, 0, 0, 1)
        ops.mass(1, 1.0, 1.0, 0.0)
        stiffness, damping = float(body.stiffness[0, 0]), float(body.damping[0, 0])
        ops.frictionModel("Coulomb", 1, body.friction / weight)
        ops.uniaxialMaterial("Elastic", 1, 1e6 * stiffness)
        ops.uniaxialMaterial("Elastic", 2, 0.0)
        ops.uniaxialMaterial("Viscous", 3, damping, 1.0)
        ops.element(
            "singleFPBearing", 1, 0, 1, 1, weight / stiffness, (1.0 + self.kt) * stiffness,
            "-P", 1, "-Mz", 2, "-orient", 0, 1, 0, -1, 0, 0,
        )  # fmt: skip
        ops.element("zeroLength", 2, 0, 1, "-mat", 3, "-dir", 1)
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.load(1, 0.0, -weight, 0.0)
        for name, *settings in (
            ("constraints", "Plain"), ("numberer", "Plain"), ("system", "FullGeneral"),
            ("test", "NormDispIncr", 1e-12, 20, 0), ("algorithm", "Newton"),
            ("integrator", "LoadControl", 1.0), ("analysis", "Static", "-noWarnings"),
        ):  # fmt: skip
            getattr(ops, name)(*settings)
        if ops.analyze(1):
            raise RuntimeError("OpenSees: the weight cannot be applied")
        ops.loadConst("-time", 0.0)
        ops.wipeAnalysis()
        ops.timeSeries("Path", 2, "-dt", body.step, "-values", *body.acceleration.tolist())
        ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
