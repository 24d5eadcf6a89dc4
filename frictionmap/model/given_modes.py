"""Structures that are given by modes: modes of tests and programs, uniform beams, rectangular plates."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, overload

import numpy as np

from .. import checks
from ..errors import InputError
from ..structures.mode_files import read_modes
from ..structures.modes import OF_BASE, Modes
from ..structures.uniform import Beam, Plate
from .general import ContactSystem
from .modes import ModalModel
from .points import Points, check_residual, missing_flexibility

#: Keys that do not go with modes, and why.
_RIVALS = {
    "matrices": "both define the structure",
    "mass_ratios": "both define the structure",
    "stiffness_ratios": "both define the structure",
    "dampers": "modes have damping_ratios",
    "reduce": "modes are a reduced structure",
    "rayleigh": "modes have damping_ratios",
    "decouple": "modes have no matrix C",
}

#: Keys of modes in a file.
_OF_FILES = ("file", "points", "normalised")

#: Keys of modes given as a mapping.
_KEYS = ("frequencies", "damping_ratios", "points", "shapes", "residual", "compliance", "modal_masses",
         "normalised", *OF_BASE)  # fmt: skip


#: Natural frequencies that are described.
_SHOWN = 6


class Owner(Protocol):
    """What is read of a system, checked or not yet."""

    @property
    def matrices(self) -> Any: ...
    @property
    def mass_ratios(self) -> Any: ...
    @property
    def excitation(self) -> Any: ...
    @property
    def stiffness_scale(self) -> float: ...
    @property
    def contact_system(self) -> ContactSystem: ...
    @property
    def modal_model(self) -> ModalModel: ...


class ModesArgument:
    """The argument `modes` of a system: what was given; the attribute of this name is the modal model.

    A changed copy of a system hands the model on, and is made of the structure that it holds already.
    """

    @overload
    def __get__(self, system: None, owner: Any = None) -> "ModesArgument": ...
    @overload
    def __get__(self, system: Owner, owner: Any = None) -> ModalModel: ...
    def __get__(self, system: Owner | None, owner: Any = None) -> "ModalModel | ModesArgument":
        return self if system is None else system.modal_model

    def __set__(self, system: Owner, given: Any) -> None:
        system.__dict__["given_modes"] = None if isinstance(given, ModesArgument) else given


def modes_of(system: Owner, given: Any) -> tuple[Modes | None, float]:
    """The modes that were given, and the stiffness scale that goes with them; None in a copy of a system.

    Raises
    ------
    InputError
        Another key defines the structure, too; or they are no modes.
    """
    if isinstance(given, ModalModel):
        if system.matrices is None and system.mass_ratios is None:
            raise InputError("modes", "must be those of a structure, not the attribute of a system; got one")
        return None, 1.0
    for name, why in _RIVALS.items():
        if getattr(system, name) is not None:
            raise InputError("cannot use", name, f"with modes: {why}; omit one")
    if isinstance(given, Beam | Plate):
        return given.as_modes(), float(given.mass * given.frequencies[0] ** 2)
    if isinstance(given, str | os.PathLike):
        return read_modes(Path(given)), 1.0
    if isinstance(given, Mapping):
        return (_from_file(given) if "file" in given else _from_mapping(given)), 1.0
    if isinstance(given, Modes):
        return given, 1.0
    raise InputError(
        "modes",
        f"must be a frictionmap.Modes, Beam or Plate, a file or a mapping; got {checks.one_line(given)}",
    )


def _check_keys(given: Mapping[Any, Any], valid: tuple[str, ...]) -> None:
    for key in given:
        if key not in valid:
            name = f"modes.{key}"
            raise InputError(f"unknown key {name!r}{checks.nearest(key, valid)}; valid: {', '.join(valid)}")
    if given.get("normalised") not in (None, "mass"):
        raise InputError("modes.normalised", f"must be 'mass'; got {checks.one_line(given['normalised'])}")


def _from_file(given: Mapping[Any, Any]) -> Modes:
    """Modes of a file, some of its points, or with shapes that are declared to be of unit modal mass."""
    _check_keys(given, _OF_FILES)
    file, points = given["file"], given.get("points")
    if not isinstance(file, str | os.PathLike):
        raise InputError("modes.file", f"must be the path of a file; got {checks.one_line(file)}")
    if points is not None and (isinstance(points, str) or not isinstance(points, Sequence) or not points):
        raise InputError("modes.points", f"must be a list of names; got {checks.one_line(points)}")
    return read_modes(Path(file), points, given.get("normalised") == "mass")


def _from_mapping(given: Mapping[Any, Any]) -> Modes:
    """Modes of a table of a configuration."""
    _check_keys(given, _KEYS)
    for key in ("frequencies", "shapes"):
        if key not in given:
            raise InputError("modes", f"must have {key}; got {', '.join(map(str, given)) or 'nothing'}")
    of_base: dict[str, Any] = {name: given.get(name) for name in OF_BASE}
    return Modes(
        given["frequencies"], given.get("damping_ratios"), normalised_shapes(given), given.get("points"),
        given.get("residual"), given.get("compliance"), **of_base,
    )  # fmt: skip


def normalised_shapes(given: Mapping[Any, Any]) -> Any:
    """Shapes of unit modal mass.

    Raises
    ------
    InputError
        Neither modal masses are given, nor that they are 1.
    """
    masses, words = given.get("modal_masses"), given.get("normalised")
    if masses is None:
        if words is None:
            raise InputError(
                "modes",
                "must state how shapes are normalised: give modal_masses, one per mode, or "
                "normalised = 'mass' for unit modal masses; got neither",
            )
        return given["shapes"]
    if words is not None:
        raise InputError("cannot use", "modes.modal_masses", "with normalised: both state them; omit one")
    sizes, shapes = checks.array(masses, "modes.modal_masses"), checks.array(given["shapes"], "modes.shapes")
    if sizes.dtype.kind not in "iuf" or sizes.ndim != 1 or shapes.ndim != 2 or sizes.size != shapes.shape[1]:
        raise InputError("modes.modal_masses", f"must be one number per mode; got {checks.one_line(masses)}")
    if not (np.isfinite(sizes) & (sizes > 0.0)).all():
        raise InputError("modes.modal_masses", f"must be > 0; got {sizes.tolist()}")
    return shapes / np.sqrt(sizes)


def damping_of(modes: Modes, given: Any) -> tuple[Modes, Any]:
    """The modes without damping ratios, and these, which a system holds."""
    if modes.zeta is None:
        return modes, given
    if given is not None:
        raise InputError("cannot use", "damping_ratios", "with modes: they have their own; omit one")
    return replace(modes, zeta=None), tuple(modes.zeta.tolist())


def on_modes(system: Owner, modes: Modes, contacts: ContactSystem, frequency: float) -> ContactSystem:
    """Contacts and loads of a system as they act on its modes, dimensionless.

    frequency : at r = 1
    """
    if system.excitation == "base" and modes.participation is None:
        raise InputError(
            "excitation",
            "must be force for modes without participation, as the load by a moving base is not known from "
            "them; got 'base'",
        )
    if contacts.has_phases:
        raise InputError(
            "cannot use",
            "springs or contacts[].normal",
            "with modes: they are for chains and matrices; omit it",
        )
    shapes = modes.shapes * (np.sqrt(system.stiffness_scale) / frequency)
    rigid = any(group.stiffness is None for group in contacts.groups)
    residual = None
    if modes.residual is not None and not (modes.optional and rigid):
        residual = modes.residual * system.stiffness_scale
    if contacts.has_banks and residual is not None and residual.any():
        raise InputError(
            "cannot use",
            "contacts[].bank",
            "= 'contact', or more than 64 elements, with modes and a residual flexibility: it is a spring in "
            "series with the bank; use up to 64 elements and bank = 'elements', or leave out the residual",
        )
    points = Points(
        shapes, contacts.vectors, contacts.forces, contacts.offset, residual,
        *_base_parts(modes, frequency, system.stiffness_scale, residual is not None),
    )  # fmt: skip
    check_residual(points, contacts.groups)
    for group in contacts.groups:
        if not (shapes.T @ group.vector).any():
            raise InputError("modes", f"must move the contact {group.name}; got zeros in all of them")
    return contacts.in_modes(points)


def _base_parts(
    modes: Modes, frequency: float, stiffness: float, softer: bool
) -> tuple[np.ndarray | None, np.ndarray | None, np.ndarray | None]:
    """What a base that moves does, dimensionless: three attributes of `Points`."""
    if modes.participation is None:
        return None, None, None
    rest = modes.base_residual * frequency**2 if softer and modes.base_residual is not None else None
    return modes.participation * (frequency / np.sqrt(stiffness)), modes.influence, rest


def describe_modes(system: Owner, hertz: bool = False) -> str:
    """Describe the modes that a structure is given by: how many, frequencies, and what they leave out.

    hertz : whether they are in SI units
    """
    modes, points = system.matrices, system.contact_system.points
    assert isinstance(modes, Modes)
    assert points is not None
    rates = ", ".join(f"{w / (2.0 * np.pi):.5g}" for w in modes.frequencies[:_SHOWN])
    more = ", ..." * (modes.frequencies.size > _SHOWN)
    frequencies = f"{rates}{more} Hz" if hertz else f"over 2 pi {rates}{more}"
    words = [f"{modes.w.size} modes, natural frequencies {frequencies}"]
    groups = system.contact_system.groups
    if points.residual is not None:
        words += [
            f"residual flexibility times the stiffness of {group.name} {share * (group.stiffness or 0.0):.3g}"
            for group, share in zip(groups, points.own, strict=True)
        ]
    words.append(missing_flexibility(points, system.modal_model.w**2, groups))
    if modes.optional and any(group.stiffness is None for group in groups):
        words.append(
            "rigid contact: on a continuum the number of stops depends on the number of modes; give a "
            "contact stiffness"
        )
    if modes.imaginary:
        words.append(f"imaginary parts of shapes left out, up to {modes.imaginary:.2g} of the real ones")
    return "; ".join(filter(None, words))
