"""NLvib under GNU Octave: harmonic balance with continuation over frequency, for one mass.

A copy of NLvib is used where the environment variable FRICTIONMAP_NLVIB names its folder (the one with SRC).
A contact with a spring is its element `elasticDryFriction`, a rigid one is regularised by `tanhDryFriction`.
Octave interprets the loop over the samples, so a point takes longer than with a compiling MATLAB.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from .curve import Curve, CurvePeer

VARIABLE = "FRICTIONMAP_NLVIB"

#: Speed over which tanh turns the friction round, over that of the unloaded mass.
REGULARISED = 0.01

#: Octave does not know MATLAB's defaults of fsolve, so all options are given.
_DRIVER = """
addpath(genpath('{source}'));
element = struct({element}, 'friction_limit_force', {beta});
mass = SingleMassOscillator(1, {damper}, 1, {{element}}, 1);
free = 1 / (1 - {low}^2 + 1i * {low} * {damper});
start = zeros(2 * {highest} + 1, 1);
start(2:3) = [real(free); -imag(free)];
residual = @(X) HB_residual(X, mass, {highest}, {samples}, 'FRF');
options = optimset('Display', 'off', 'Jacobian', 'on', 'MaxIter', 50, 'TolX', 1e-10, 'TolFun', 1e-10);
began = tic;
X = solve_and_continue(start, residual, {low}, {high}, 0.05, struct('dsmax', 0.1), {{}}, options);
seconds = toc(began);
dlmwrite('{curve}', [X; seconds * ones(1, columns(X))], 'delimiter', ' ', 'precision', 17);
"""


class NLvib(CurvePeer):
    """Frequency response by `solve_and_continue` with its default predictor and parametrisation."""

    name = "NLvib"
    most = 5

    @classmethod
    def why_missing(cls) -> str:
        """Return why NLvib cannot run here, or "" if it can."""
        if not cls._source().is_dir():
            return f"{VARIABLE} names no folder of NLvib"
        return "" if shutil.which("octave-cli") else "there is no octave-cli"

    @classmethod
    def _source(cls) -> Path:
        return Path(os.environ.get(VARIABLE) or os.devnull) / "SRC"

    @classmethod
    def version(cls) -> str:
        """Versions of NLvib and of Octave."""
        text = (cls._source() / "solve_and_continue.m").read_text(encoding="utf-8", errors="replace")
        found = re.search(r"NLvib Version ([\d.]+)", text)
        said = subprocess.run(["octave-cli", "--version"], capture_output=True, text=True, check=True)
        octave = re.search(r"version ([\d.]+)", said.stdout)
        return " under Octave ".join(one.group(1) if one else "unknown" for one in (found, octave))

    def curve(self, highest: int) -> Curve:
        """Follow the curve in a process of Octave; the time is that inside of it."""
        rig = self.rig
        spring = f"'type', 'elasticDryFriction', 'stiffness', {rig.stiffness}, 'ishysteretic', true"
        rigid = f"'type', 'tanhDryFriction', 'eps', {REGULARISED}"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "curve.txt"
            text = _DRIVER.format(
                source=self._source(), element=spring if rig.stiffness else rigid, beta=rig.beta,
                damper=2.0 * rig.zeta, low=rig.frequencies[0], high=rig.frequencies[1], highest=highest,
                samples=self.samples(highest), curve=path,
            )  # fmt: skip
            (Path(folder) / "driver.m").write_text(text)
            command = ["octave-cli", "--no-gui", "--quiet", str(Path(folder) / "driver.m")]
            try:
                done = subprocess.run(command, capture_output=True, text=True, timeout=10 * self.limit)
            except subprocess.TimeoutExpired:
                raise RuntimeError(f"no curve after {10 * self.limit} s") from None
            if not path.is_file():
                raise RuntimeError(next(iter(done.stderr.splitlines()), "no curve"))
            *rows, r, seconds = np.loadtxt(path, ndmin=2)
        cosines, sines = np.array(rows[1::4]).T, np.array(rows[2::4]).T  # of odd harmonics
        return Curve(float(seconds[0]), r, cosines - 1j * sines, 0)
