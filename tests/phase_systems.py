"""Systems of contacts that open and piecewise linear springs, from the rows of an independent program."""

import numpy as np

from frictionmap.model.spring_element import SpringElement
from frictionmap.phases.system import PhaseContact, PhaseSystem


def contact_of(one):
    own = {
        "stiffness": one.get("kt", 0.0), "static": one.get("mu", 1.0),
        "wall_speed": one.get("wall_speed", 0.0),
    }  # fmt: skip
    if "d" in one:
        own |= {
            "normal": np.array(one["d"], float), "normal_stiffness": one["kn"], "friction": one["phi"],
            "preload": one["N0"],
        }  # fmt: skip
    else:
        own |= {"ratio": None, "limit": one["beta"]}
    return PhaseContact(np.array(one["c"], float), **own)


def spring_of(one):
    u, force = np.array(one["knots"], float).T
    return SpringElement(np.array(one["c"], float), u, force, one["slopes"][0], one["slopes"][-1])


def system_of(row):
    contacts = [contact_of(one) for one in row["contacts"] if one["kind"] != "spring"]
    springs = [spring_of(one) for one in row["contacts"] if one["kind"] == "spring"]
    loads = {int(n): np.array([complex(*z) for z in load]) for n, load in row.get("loads", {}).items()}
    offset = None if row.get("offset") is None else np.array(row["offset"], float)
    mass, damping, stiffness = (np.array(row[key], float) for key in "MCK")
    return PhaseSystem(mass, damping, stiffness, contacts, springs, loads, offset=offset)


def split(row, name):
    """Numbers of a row for contacts, and for springs."""
    kinds = [one["kind"] == "spring" for one in row["contacts"]]
    values = np.array(row[name], float)
    return values[~np.array(kinds)], values[kinds]
