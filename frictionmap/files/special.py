"""Short configurations of special systems: belts without a load, contacts that open, modes, beams, rings.

They run as they stand with the commands that their first lines name.
"""

from typing import NamedTuple


class _Special(NamedTuple):
    """A short configuration; pairs are in units and in ratios."""

    title: str
    commands: tuple[str, ...]  # beside map and plot
    cell: tuple[str, str]  # options of `response`
    text: tuple[str, str]  # all tables


_CELL = ("--r '10 Hz' --beta '30 N'", "--r 0.6 --beta 0.3")

_TWO_MASSES = """\
[system]
masses = ["40 kg", "20 kg"]
springs = ["500 N/mm", "250 N/mm"]
damping_ratios = 0.02
"""
_TWO_RATIOS = """\
[system]
mass_ratios = [1.0, 0.5]
stiffness_ratios = [1.0, 0.5]
damping_ratios = 0.02
"""
_ONE_MASS = """\
[system]
masses = ["40 kg"]
springs = ["500 N/mm"]
damping_ratios = 0.02
"""
_ONE_RATIO = """\
[system]
mass_ratios = [1.0]
stiffness_ratios = [1.0]
damping_ratios = 0.02
"""
_LOAD = """\
[units]
load = "100 N"
"""
_GRID = """\
[grid]
r = { start = "4 Hz", stop = "40 Hz", step = "0.4 Hz" }
beta = { start = "0 N", stop = "120 N", num = 61 }
"""
_GRID_OF_RATIOS = """\
[grid]
r = { start = 0.2, stop = 2.2, step = 0.02 }
beta = { start = 0.0, stop = 1.2, num = 61 }
"""
_PRELOAD = """\
[design]
question = "stuck"                # beta with which the damper can hold
#question = "no-separation"       # the least preload from which it never opens
band = {}
"""

#: Motions in time under a force on the loaded point, commented out: in units and in ratios.
_MOTION = """\
#[record]                         # for motions in time: frictionmap history
#quantity = "force"               # on load_mass
#unit = "N"
#pulse = { kind = "half-sine", amplitude = "20 N", duration = "10 ms" }      # or file = "blow.csv"
#[history]
#friction = ["2 N", "5 N"]
"""
_MOTION_OF_RATIOS = """\
#[record]                         # for motions in time: frictionmap history
#quantity = "force"               # on load_mass
#pulse = { kind = "half-sine", amplitude = 2.0, duration = 2.0 }      # over P; or file = "blow.csv"
#[history]
#beta = [0.2, 0.5]
"""

_RING = """\
[system]
load_mass = 1
damping_ratios = 0.01
[system.sectors]                  # masses 1 and 2: a blade, and its part of the disk
count = 6
engine_order = 2                  # of the load, which travels round
mass = [[1.0, 0.0], [0.0, 4.0]]
stiffness = [[1.0, -1.0], [-1.0, 5.0]]
coupling = [{ masses = [2, 2], stiffness = 2.0 }]
[[system.contacts]]
kind = "between-masses"
masses = [1, "next.1"]
"""

#: By the option of `init`.
SPECIAL = {
    "normal": _Special(
        "A damper that opens: its normal force follows the motion",
        ("curves", "boundaries", "response", "design"),
        _CELL,
        (
            f"""\
{_TWO_MASSES}[[system.contacts]]
masses = [1]
stiffness = "500 N/mm"
normal = {{ mass = 2, stiffness = "250 N/mm", friction = 0.4 }}      # beta = 0.4 times the preload
{_LOAD}{_GRID}{_PRELOAD.format('["6 Hz", "40 Hz"]')}""",
            f"""\
{_TWO_RATIOS}[[system.contacts]]
masses = [1]
stiffness = 1.0
normal = {{ mass = 2, stiffness = 0.5, friction = 0.4 }}      # beta = 0.4 times the preload
{_GRID_OF_RATIOS}{_PRELOAD.format("[0.3, 2.2]")}""",
        ),
    ),
    "backlash": _Special(
        "A slide with backlash in its drive",
        ("curves", "response"),
        _CELL,
        (
            f"""\
{_ONE_RATIO}[[system.springs]]
masses = [1]                      # to the ground; [1, 2] is between two masses
backlash = "0.1 mm"               # to either side; or gap, or displacement and force
stiffness = "500 N/mm"
[units]
mass = "40 kg"
stiffness = "500 N/mm"
load = "100 N"
{_GRID}""",
            f"""\
{_ONE_RATIO}[[system.springs]]
masses = [1]                      # to the ground; [1, 2] is between two masses
backlash = 0.5                    # to either side; or gap, or displacement and force
stiffness = 1.0
{_GRID_OF_RATIOS}""",
        ),
    ),
    "law": _Special(
        "Friction that falls with the speed",
        ("curves", "boundaries", "response"),
        _CELL,
        (
            f"""\
{_ONE_MASS}[[system.contacts]]
law = {{ formula = "gauss", kinetic = 0.75, speed = "20 mm/s" }}      # friction over that just above speed 0
{_LOAD}{_GRID}""",
            f"""\
{_ONE_RATIO}[[system.contacts]]
law = {{ formula = "gauss", kinetic = 0.75, speed = 0.9 }}      # friction over that just above speed 0
{_GRID_OF_RATIOS}""",
        ),
    ),
    "squeal": _Special(
        "A mass on a belt without a load",
        ("boundaries", "response"),
        ("--wall-speed '10 mm/s' --beta '60 N'", "--wall-speed 0.4 --beta 0.6"),
        (
            f"""\
{_ONE_MASS}[[system.contacts]]
law = {{ formula = "gauss", kinetic = 0.75, speed = "20 mm/s" }}      # friction over that just above speed 0
[units]
load = "100 N"                    # any force: numbers of beta without a unit are over it
[grid]
wall_speed = {{ start = "1 mm/s", stop = "60 mm/s", num = 60 }}
beta = {{ start = "2 N", stop = "120 N", num = 60 }}
""",
            f"""\
{_ONE_RATIO}[[system.contacts]]
law = {{ formula = "gauss", kinetic = 0.75, speed = 0.9 }}      # friction over that just above speed 0
[grid]
wall_speed = {{ start = 0.05, stop = 2.7, num = 60 }}      # over omega_1 P/k_1
beta = {{ start = 0.02, stop = 1.2, num = 60 }}
""",
        ),
    ),
    "modes": _Special(
        "A structure given by its modes",
        ("curves", "boundaries", "response", "design"),
        ("--r '18 Hz' --beta '2 N'", "--r 1.0 --beta 0.2"),
        (
            """\
[system]
contact_masses = ["tip"]
contact_stiffness = "20 N/mm"
load_mass = "shaker"
[system.modes]                    # or modes = "rig.csv", "rig.uff", ..
frequencies = ["18 Hz", "55 Hz"]
damping_ratios = [0.02, 0.01]
points = ["tip", "shaker"]
shapes = [[0.3, 0.25], [0.15, -0.2]]      # a row per point
normalised = "mass"
[units]
load = "10 N"
[grid]
r = { start = "10 Hz", stop = "60 Hz", step = "0.5 Hz" }
beta = { start = "0.1 N", stop = "8 N", num = 61 }
[design]
question = "stuck"                # the friction with which the contact holds
band = ["12 Hz", "30 Hz"]
"""
            + _MOTION,
            """\
[system]
contact_masses = ["tip"]
contact_stiffness = 1.5
load_mass = "shaker"
stiffness_scale = 1.0
[system.modes]                    # or modes = "rig.csv", "rig.uff", ..
frequencies = [1.0, 3.0]
damping_ratios = [0.02, 0.01]
points = ["tip", "shaker"]
shapes = [[0.3, 0.25], [0.15, -0.2]]      # a row per point
normalised = "mass"
[grid]
r = { start = 0.5, stop = 3.5, step = 0.03 }
beta = { start = 0.01, stop = 0.8, num = 61 }
[design]
question = "stuck"                # the friction with which the contact holds
band = [0.7, 1.7]
"""
            + _MOTION_OF_RATIOS,
        ),
    ),
    "beam": _Special(
        "A cantilever with a friction damper at its tip",
        ("curves", "boundaries", "response", "design"),
        ("--r '45 Hz' --beta '2 N'", "--r 1.2 --beta 0.2"),
        (
            """\
[system]
contact_masses = ["tip"]
contact_stiffness = "5 N/mm"
load_mass = "middle"
damping_ratios = 0.01
[system.beam]
ends = "clamped-free"             # clamped, pinned, free, guided
length = "300 mm"
bending_stiffness = "21 N m^2"    # or E with width and height, or diameter
mass_per_length = "0.78 kg/m"     # or density
points = { tip = "300 mm", middle = "150 mm" }
[units]
load = "10 N"
[grid]
r = { start = "20 Hz", stop = "100 Hz", step = "1 Hz" }
beta = { start = "0.1 N", stop = "8 N", num = 61 }
[design]
question = "stuck"                # the friction with which the contact holds
band = ["30 Hz", "90 Hz"]
"""
            + _MOTION,
            """\
[system]
contact_masses = ["tip"]
contact_stiffness = 0.5
load_mass = "middle"
damping_ratios = 0.01
[system.beam]
ends = "clamped-free"             # clamped, pinned, free, guided
length = 1.0
bending_stiffness = 1.0           # or E with width and height, or diameter
mass_per_length = 1.0             # or density
points = { tip = 1.0, middle = 0.5 }
[grid]
r = { start = 0.5, stop = 2.5, step = 0.02 }
beta = { start = 0.01, stop = 0.8, num = 61 }
[design]
question = "stuck"                # the friction with which the contact holds
band = [0.8, 2.2]
"""
            + _MOTION_OF_RATIOS,
        ),
    ),
    "ring": _Special(
        "A bladed disk with dampers between neighbours",
        ("curves", "boundaries", "response", "design"),
        ("--r '90 Hz' --beta '30 N'", "--r 0.9 --beta 0.3"),
        (
            _RING
            + """\
stiffness = "100 N/mm"
[units]
natural_frequency = "100 Hz"
stiffness = "500 N/mm"
load = "100 N"
[grid]
r = { start = "70 Hz", stop = "120 Hz", step = "1 Hz" }
beta = { start = "2 N", stop = "120 N", num = 31 }
[design]
question = "stuck"                # the friction with which all dampers hold
band = ["70 Hz", "120 Hz"]""",
            _RING
            + """\
stiffness = 0.2
[grid]
r = { start = 0.7, stop = 1.2, step = 0.01 }
beta = { start = 0.02, stop = 1.2, num = 31 }
[design]
question = "stuck"                # the friction with which all dampers hold
band = [0.7, 1.2]""",
        ),
    ),
}


def special_configuration(name: str, kind: str, in_units: bool = True) -> str:
    """Return the text of a short configuration that runs as it stands with the commands that it names.

    name : file name without its suffix
    kind : one of `SPECIAL`
    in_units : numbers in kilograms, newtons and hertz, or ratios
    """
    one, place = SPECIAL[kind], 0 if in_units else 1
    others = ", ".join(command for command in one.commands if command != "response")
    return "".join(
        [
            f"# frictionmap map {name}.toml && frictionmap plot {name}.nc; also {others}\n",
            f"# frictionmap response {name}.toml {one.cell[place]}\n",
            f'title = "{one.title}"\n',
            one.text[place],
        ]
    )
