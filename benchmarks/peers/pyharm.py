"""pyHarm: harmonic balance with continuation over frequency, for one mass and a contact with the ground.

A contact with a spring is its Jenkins element, a rigid one its friction element of the dynamic Lagrangian
method (DLFT).  Settings: odd harmonics alone, as the response to one harmonic is antiperiodic; its default
solver (`scipy.optimize.root`), predictor (tangent) and corrector (arc length); steps of at most `STEP`.
"""

import logging
import tempfile
import time
import warnings
from contextlib import chdir
from importlib import import_module
from importlib.util import find_spec

import numpy as np

from .curve import Curve, CurvePeer, Rig

#: Step of the continuation at most and at least.
STEP, LEAST_STEP = 0.1, 1e-6

#: Penalty of the dynamic Lagrangian method, over k_1: with 1 the error is five times as large.
PENALTY = 1000.0


class PyHarm(CurvePeer):
    """Analysis of type frf, with a limit of time."""

    name = "pyHarm"
    package = "pyHarm"
    distribution = "pyharm-os"

    def _description(self, highest: int) -> dict:
        """Input of pyHarm for the odd harmonics up to `highest`."""
        rig = self.rig
        place = {"connect": {"mass": [0], "GROUND": [0]}, "dirs": [0], "mu": 1.0, "N0": rig.beta}
        rigid = {"type": "DLFTFriction", "eps": PENALTY}
        contact = {"type": "Jenkins", "k": rig.stiffness} if rig.stiffness else rigid
        load = {"type": "GOForcing", "connect": {"mass": [0]}, "dirs": [0], "amp": 1.0, "dto": 0, "ho": 1}
        matrices = {"M": [[1.0]], "C": [[2.0 * rig.zeta]], "K": [[1.0]], "G": [[0.0]]}
        low, high = rig.frequencies
        return {
            "system": {
                "type": "Base", "nh": list(range(1, highest + 1, 2)), "nti": self.samples(highest)
            },
            "substructures": {
                "mass": {"matrix": {key: np.array(value) for key, value in matrices.items()}, "ndofs": 1}
            },
            "connectors": {"load": load, "contact": place | contact},
            "analysis": {
                "curve": {
                    "study": "frf", "puls_inf": low, "puls_sup": high, "ds0": STEP, "ds_max": STEP,
                    "ds_min": LEAST_STEP, "verbose": False,
                    "stopper_options": {"timeout": {"status": True, "timeout": f"0:0:0:{self.limit}"}},
                }
            },
        }  # fmt: skip

    def __init__(self, rig: Rig) -> None:
        super().__init__(rig)
        self.curve(1)  # compiles

    @classmethod
    def why_missing(cls) -> str:
        """Return why pyHarm cannot run here, or "" if it can; importing it would write into this folder."""
        return "" if find_spec(cls.package) else f"{cls.package} is not installed"

    def curve(self, highest: int) -> Curve:
        """Follow the curve in an empty folder; the time is that of the analysis."""
        logging.disable(logging.INFO)
        try:
            with tempfile.TemporaryDirectory() as folder, chdir(folder), warnings.catch_warnings():
                warnings.simplefilter("ignore")  # performance of compiled code
                return self._followed(highest)
        finally:
            logging.disable(logging.NOTSET)

    def _followed(self, highest: int) -> Curve:
        program = import_module("pyHarm.Maestro").Maestro(self._description(highest))
        for element in program.system.LE_nonlinear_dlft:
            element.nbSub = 1  # counts the ground, which has no equations: the friction would be half
        began = time.perf_counter()
        program.operate()
        seconds = time.perf_counter() - began
        steps = program.nls["curve"].SolList
        kept = [step.x for step in steps if step.flag_accepted]
        if not kept:
            raise RuntimeError("no step converged")
        x = np.array(kept)
        return Curve(seconds, x[:, -1], x[:, :-1:2] - 1j * x[:, 1::2], len(steps) - len(kept))
