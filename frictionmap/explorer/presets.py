"""Systems that the page offers besides the one that it was opened with."""

from functools import cache
from typing import NamedTuple

from .. import checks
from ..errors import InputError
from .scene import Scene, scene_of


class Preset(NamedTuple):
    """A system that can be chosen, as a configuration."""

    label: str
    text: str


_GRID = "[grid]\nr = [0.0, 2.0]\nbeta = [0.0, 1.2]\n"

_FRAME = """\
title = "Two-storey frame with brace dampers"
[system]
excitation = "base"
damping_reference = "base"
mass_ratios = [1.0, 1.0]
stiffness_ratios = [1.0, 1.0]
damping_ratios = 0.02
[[system.contacts]]
name = "lower brace"
kind = "joined-base-wall"
masses = [1]
[[system.contacts]]
name = "upper brace"
kind = "between-masses"
masses = [1, 2]
ratio = 0.5
[units]
natural_frequency = "2.5 Hz"
base_amplitude = "10 mm"
stiffness = "8 kN/mm"
[grid]
r = ["0.5 Hz", "5 Hz"]
beta = ["0 kN", "160 kN"]
"""

_BRAKE_PAD = """\
title = "Brake pad on its disc"
[units]
load = "160 N"
[system]
masses = ["0.5 kg"]
springs = ["500 N/mm"]
damping_ratios = 0.02
[[system.contacts]]
kind = "fixed-wall"
masses = [1]
law = { formula = "exponential", kinetic = 0.75, speed = "0.1 m/s", error = 0.005 }
[grid]
wall_speed = ["5 mm/s", "600 mm/s"]
beta = ["4 N", "240 N"]
"""

PRESETS = {
    "fixed-wall": Preset(
        "one mass on a fixed wall",
        f'title = "One mass on a fixed wall"\n[system]\ncontact = "fixed-wall"\n{_GRID}',
    ),
    "joined-base-wall": Preset(
        "one mass, wall on the base",
        'title = "One mass and a wall on the moving base"\n[system]\ncontact = "joined-base-wall"\n'
        "[grid]\nr = [0.0, 2.5]\nbeta = [0.0, 2.0]\n",
    ),
    "two-masses": Preset(
        "two masses, friction between them",
        'title = "Friction between two masses"\n[system]\n'
        'contact = "between-masses"\ncontact_masses = [1, 2]\n'
        "mass_ratios = [1.0, 0.5]\nstiffness_ratios = [1.0, 2.0]\ndamping_ratios = 0.01\n"
        "[grid]\nr = [0.1, 2.5]\nbeta = [0.0, 1.2]\n",
    ),
    "brace-dampers": Preset("frame with brace dampers", _FRAME),
    "elastic-contact": Preset(
        "contact with a spring",
        'title = "One mass and a contact with a spring"\n[system]\n'
        "damping_ratios = 0.02\ncontact_stiffness = 1.0\n"
        "[grid]\nr = [0.3, 1.8]\nbeta = [0.0, 1.2]\n",
    ),
    "belt": Preset(
        "mass on a belt",
        'title = "Mass on a belt"\n[system]\ndamping_ratios = 0.02\nwall_velocity = 0.5\n'
        "[grid]\nr = [0.1, 2.0]\nbeta = [0.0, 1.2]\n",
    ),
    "brake-pad": Preset("brake pad on its disc, no load", _BRAKE_PAD),
}


@cache
def preset_scene(key: str) -> Scene:
    """Make the scene of a preset.

    Raises
    ------
    InputError
        There is no such preset.
    """
    from ..files.config import config_of

    if key not in PRESETS:
        raise InputError(f"unknown preset {checks.one_line(key)}; valid: {', '.join(PRESETS)}")
    return scene_of(config_of(PRESETS[key].text, {}))
