"""Siconos: Moreau-Jean time stepping with its solver for friction, for one mass under a load.

Siconos is a package of some systems, with a Python of its own: FRICTIONMAP_SICONOS names that Python
(on Debian /usr/bin/python3 with the package python3-siconos).  A second degree of freedom presses the contact
with the force beta; its coefficient of friction is 1.
"""

import json
import math
import os
import subprocess

from .contacts import ContactBody, ContactCell, ContactOutcome, ContactPeer

VARIABLE = "FRICTIONMAP_SICONOS"


#: Program for that Python: runs cells, one a line of standard input.
_DRIVER = """
import json, math, sys
import numpy as np
import siconos.kernel as sk
for line in sys.stdin:
    r, zeta, beta, steps, cycles = json.loads(line)
    h = 2.0 * math.pi / steps
    inertia, springs, dampers = (np.diag(row) for row in ([r * r, 1.0], [1.0, 0.0], [2 * zeta * r, 0.0]))
    mass = sk.LagrangianLinearTIDS(np.zeros(2), np.zeros(2), inertia, springs, dampers)
    mass.setFExtPtr(np.array([0.0, -beta]))
    force = mass.fExt()  # a view
    law = sk.NewtonImpactFrictionNSL(0.0, 0.0, 1.0, 2)
    model = sk.NonSmoothDynamicalSystem(0.0, h * steps * (cycles + 1))
    model.insertDynamicalSystem(mass)
    relation = sk.LagrangianLinearTIR(np.array([[0.0, 1.0], [1.0, 0.0]]))
    model.link(sk.Interaction(law, relation), mass)
    clock, scheme = sk.TimeDiscretisation(0.0, h), sk.MoreauJeanOSI(0.5)
    stepping = sk.TimeStepping(model, clock, scheme, sk.FrictionContact(2))
    loads = [0.5 * (math.cos(h * k) + math.cos(h * (k + 1))) for k in range(steps)]
    found = []
    for cycle in range(cycles):
        for load in loads:
            force[0] = load
            stepping.computeOneStep()
            stepping.nextStep()
            if cycle == cycles - 1:
                found.append(float(mass.q()[0]))
    print(">" + json.dumps(max(found) - min(found)), flush=True)
"""


class Siconos(ContactPeer):
    """One mass with a rigid contact under the first harmonic, `steps` steps per period."""

    name = "Siconos"

    def __init__(self, body: ContactBody, steps: int = 256) -> None:
        super().__init__(body)
        self.steps = steps
        command = [os.environ[VARIABLE], "-c", _DRIVER]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
            env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
        )  # fmt: skip
        self.run(ContactCell(0.8, (0.4,)), 1)  # imported by then

    @classmethod
    def why_missing(cls) -> str:
        """Return why Siconos cannot run here, or "" if it can."""
        python = os.environ.get(VARIABLE)
        if not python:
            return f"{VARIABLE} names no Python with siconos"
        done = subprocess.run([python, "-c", "import siconos.kernel"], capture_output=True, check=False)
        return "" if done.returncode == 0 else f"{python} has no siconos"

    def run(self, cell: ContactCell, cycles: int) -> ContactOutcome:
        """March one cell from rest; stops are not counted."""
        asked = cell.r, self.body.zeta, cell.beta[0], self.steps, cycles
        pipes = self.process.stdin, self.process.stdout
        if pipes[0] is None or pipes[1] is None or self.process.poll() is not None:
            raise RuntimeError("siconos ended")
        pipes[0].write(json.dumps(asked) + "\n")
        pipes[0].flush()
        for said in pipes[1]:
            if said.startswith(">"):  # other lines are messages of the program
                return ContactOutcome((math.nan,), (json.loads(said[1:]),))
        raise RuntimeError("siconos ended")

    def __del__(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.communicate()  # closes the pipes
