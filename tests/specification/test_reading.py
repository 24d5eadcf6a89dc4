"""What is read: files and slices of them in one form, and one line for everything that makes no sense."""

import re
import warnings

import numpy as np
import pytest
import xarray as xr
from fuzz import malformed
from fuzz.reading import refused
from outputs import OF_ONE_CONTACT

import frictionmap as fm
from frictionmap import InputError
from frictionmap.datasets.labels import BESIDE, COORDINATES, GENERAL_VARIABLES, LABELS, MEASURE_OF, in_si
from frictionmap.files.reading import read, standard_form
from frictionmap.files.storage import write
from frictionmap.files.summary import describe_file
from frictionmap.plot import PICTURED

TWO = fm.System(mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 2.0], damping_ratios=0.02)
UNITS = fm.Units(natural_frequency="4.2 Hz", load="12.5 N", stiffness="3 N/mm", normal_force="50 N")
KINDS = ("map", "curves", "boundaries", "response", "shares")


@pytest.fixture(scope="module")
def datasets():
    """One of each kind, with every variable that there is of it."""
    undamped = fm.System(mass_ratios=[1.0, 0.5], stiffness_ratios=[1.0, 2.0])
    r, mu = np.linspace(0.0, 3.0, 31), np.array([1.0, 1.5])
    quantities = ["amplitude", "phase", "first_harmonic", "energy", "harmonics", "transmitted_force"]
    samples = {"mass_ratios[2]": [0.4, 0.5, 0.6]}
    uncertain = fm.sweep(TWO, [0.0, 0.3, 2.0], [0.0, 0.5], [1.0, 1.5], axes={"sample": samples}, units=UNITS)
    return {
        "shares": fm.shares(uncertain, "sample"),
        "map": fm.sweep(
            TWO,
            [0.0, 0.3, 0.5, 2.0],
            [0.0, 0.05, 0.5, 2.0, 5.0],
            [1.0, 1.5],
            outputs=OF_ONE_CONTACT,
            units=UNITS,
        ),
        "curves": fm.curves(
            TWO,
            [0.0, 0.3, 0.5, 2.0],
            [0.0, 0.05, 0.5],
            [1.0, 1.5],
            harmonics=2,
            quantities=quantities,
            units=UNITS,
        ),
        "boundaries": fm.boundaries(undamped, r, mu, units=UNITS),
        "response": fm.response(TWO, 0.3, 0.1, 1.5, points=50, units=UNITS),
    }


@pytest.fixture(scope="module")
def files(datasets, tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    for kind, ds in datasets.items():
        write(ds, folder / f"{kind}.nc")
    return {kind: folder / f"{kind}.nc" for kind in KINDS}


def through_a_file(ds, path, **options):
    """A dataset that a user saved with plain xarray, read again."""
    ds.to_netcdf(path, **options)
    return read(path)


# Standard form


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_computed_is_in_standard_form(datasets, kind):
    xr.testing.assert_identical(standard_form(datasets[kind]), datasets[kind])


def test_every_variable_is_in_the_examples(datasets):
    """So that the tests below see all of the schema; see test_general_systems for the others."""
    known = {name for ds in datasets.values() for name in ds.variables}
    of_contacts = {
        *GENERAL_VARIABLES, "beta_stick_contact", "limiting_contact", "limit_kind", "beta_noslip",
        "no_stop_begin", "no_stop_end", "wall_velocity_lim", "y", "load", "event_contact", "contact",
        "contact_name", "point_name", "beta_slope_lim", "beta_slope_certificate", "wall_speed_lim",
        "segment", "spring", "spring_name", "normal_force", "open", "spring_force", "event_open",
        "self_locking", "friction_lim", "friction_lim_kind", "friction_on_mass", "elongation",
    }  # fmt: skip
    of_contacts |= {
        "border_r",
        "border_beta",
        "border_kind",
        "border_mu",
        "stops_below",
        "stops_above",
    }  # test_borders_file
    of_contacts |= {in_si(name, MEASURE_OF[name]) for name in of_contacts if name in MEASURE_OF}
    assert known | of_contacts >= set(LABELS) | set(COORDINATES) | set(BESIDE)
    assert not known & of_contacts


SLICES = {
    "transposed": (lambda ds: ds.transpose(*reversed(list(ds.dims))), lambda ds: ds),
    "turned round": (lambda ds: ds.isel(r=slice(None, None, -1)), lambda ds: ds),
    "one mu": (lambda ds: ds.isel(mu=1), lambda ds: ds.isel(mu=[1])),
    "one r": (lambda ds: ds.isel(r=2), lambda ds: ds.isel(r=[2])),
    "one r and mu": (lambda ds: ds.isel(r=2, mu=0), lambda ds: ds.isel(r=[2], mu=[0])),
    "one mass": (lambda ds: ds.isel(dof=0), lambda ds: ds.isel(dof=[0])),
    "a range": (lambda ds: ds.sel(r=slice(0.2, 1.0)), lambda ds: ds.sel(r=slice(0.2, 1.0))),
    "some variables": (lambda ds: ds[["beta_lim", "beta_stick"]], lambda ds: ds[["beta_lim", "beta_stick"]]),
    "with another's variable": (lambda ds: ds.assign(mine=("other", ["a", "b"])), lambda ds: ds),
}


@pytest.mark.parametrize("kind", ["map", "boundaries"])
@pytest.mark.parametrize("cut", SLICES)
def test_slices_come_in_standard_form(datasets, kind, cut, tmp_path):
    make, keep = SLICES[cut]
    part, expected = make(datasets[kind]), keep(datasets[kind])
    expected = expected.drop_vars([name for name in expected.coords if name not in part.coords])
    xr.testing.assert_identical(standard_form(part), expected)
    xr.testing.assert_identical(through_a_file(part, tmp_path / "slice.nc"), expected)


@pytest.mark.parametrize(
    ("cut", "kept"),
    [
        ({"beta": 1}, {"beta": [1]}),
        ({"mu": 0, "r": 1, "beta": 2}, {"mu": [0], "r": [1], "beta": [2]}),
    ],
)
def test_a_chosen_beta_is_still_a_map(datasets, cut, kept):
    xr.testing.assert_identical(standard_form(datasets["map"].isel(cut)), datasets["map"].isel(kept))


@pytest.mark.parametrize(
    ("cut", "kept"),
    [
        ({"tau": slice(5, 20)}, {"tau": slice(5, 20)}),
        ({"dof": 1}, {"dof": [1]}),
        ({"event": slice(0, 0)}, {"event": slice(0, 0)}),
    ],
)
def test_a_response_is_of_one_cell(datasets, cut, kept, tmp_path):
    ds = datasets["response"]
    expected = ds.isel(kept)
    for part in (ds.isel(cut), ds.isel(cut).expand_dims("mu"), ds.isel(cut).expand_dims(["r", "beta"])):
        xr.testing.assert_identical(standard_form(part), expected)
        xr.testing.assert_identical(through_a_file(part, tmp_path / "slice.nc"), expected)


@pytest.mark.parametrize("kind", KINDS)
def test_other_types_of_whole_values_are_read(datasets, kind, tmp_path):
    """Programs make floats of codes to have a fill value, and halve the digits to save room."""
    ds = datasets[kind]
    coded = [name for name in ds.data_vars if ds[name].dtype.kind == "i"]
    for dtype in ("float32", "int64", "uint8"):
        changed = {n: ds[n].astype(dtype) for n in coded if dtype != "uint8" or (ds[n] >= 0).all()}
        xr.testing.assert_identical(standard_form(ds.assign(changed)), ds)
    encoding = {name: {"_FillValue": 99} for name in coded}
    xr.testing.assert_identical(through_a_file(ds, tmp_path / "filled.nc", encoding=encoding), ds)
    swapped = ds.assign({name: ds[name].astype(">f8") for name in ds.data_vars if ds[name].dtype == float})
    xr.testing.assert_identical(through_a_file(swapped, tmp_path / "swapped.nc"), ds)


# Older names

#: Older names of variables and the current ones, by kind of file.
OLDER = {
    "curves": {"phase": "phase_lag"},
    "response": {"phase": "direction", "event_phase": "event_direction"},
}


@pytest.mark.parametrize("kind", OLDER)
def test_older_names_are_kept_with_the_current_ones(files, kind):
    with xr.open_dataset(files[kind]) as ds:
        for old, new in OLDER[kind].items():
            assert ds[old].dtype == ds[new].dtype
            np.testing.assert_array_equal(ds[old], ds[new])
            assert ds[old].attrs["long_name"] == f"older name of {new}: {ds[new].attrs['long_name']}"


@pytest.mark.parametrize("kind", OLDER)
def test_a_file_with_older_names_only_is_drawn_and_summarised(datasets, kind, tmp_path):
    """As version 0.2.0 wrote it; read by this package, or by xarray alone."""
    ds = datasets[kind]
    path = tmp_path / "older.nc"
    older = ds.drop_vars(OLDER[kind].values())
    older.to_netcdf(path)
    draw = {"curves": fm.plot_curves, "response": fm.plot_response}[kind]
    expected = [line.get_xydata() for ax in draw(ds) for line in ax.lines]
    for found in (older, read(path), read(path, PICTURED)):
        drawn = [line.get_xydata() for ax in draw(found) for line in ax.lines]
        for one, other in zip(drawn, expected, strict=True):
            np.testing.assert_array_equal(one, other)
    assert sorted(describe_file(older).splitlines()) == sorted(describe_file(ds).splitlines())
    xr.testing.assert_identical(standard_form(older), standard_form(ds))


# What makes no sense


REFUSED = [
    ("map", lambda ds: ds.isel(mu=0, drop=True), "regime has no dimension mu: .* got none"),
    ("map", lambda ds: ds.mean("r"), "regime has no dimension r: .* got none"),
    ("map", lambda ds: ds.rename(r="q"), r"regime must have the dimensions \(mu, r, beta\).*; got .*q"),
    ("map", lambda ds: ds.drop_vars("r"), "r must be a coordinate; got no such coordinate"),
    ("map", lambda ds: ds.isel(r=slice(0, 0)), "r must have at least one value; got none"),
    ("map", lambda ds: ds.isel(r=[0, 2, 1]), "r must be strictly increasing; got 0.3 after 0.5"),
    ("map", lambda ds: ds.isel(beta=[1, 1]), "beta must be strictly increasing; got 0.05 after 0.05"),
    ("map", lambda ds: ds.assign_coords(mu=[0.5, 1.0]), r"mu must be finite, >= 1; got 0.5 at \[0\]"),
    ("map", lambda ds: ds.assign_coords(beta=ds.beta - 1), r"beta must be finite, >= 0; got -1.0 at \[0\]"),
    ("map", lambda ds: ds.assign_coords(r=[0, 1, 2, np.nan]), r"r must be finite, .*; got nan at \[3\]"),
    ("map", lambda ds: ds.assign_coords(r=["a", "b", "c", "d"]), "r must be numbers; got type str"),
    ("map", lambda ds: ds.stack(c=("r", "beta")).reset_index("c"), r"r must have the dimensions .*\(c\)"),
    ("map", lambda ds: ds.where(ds.r > 0.1), r"regime must be one of -1, 0, 1, 2, 3; got nan at \[0, 0, 0\]"),
    ("map", lambda ds: ds.assign(regime=ds.regime + 0.5), "regime must be one of -1, 0, 1, 2, 3; got"),
    ("map", lambda ds: ds.assign(regime=ds.regime + 100), "regime must be one of .* got 102 at"),
    ("map", lambda ds: ds.assign(regime=ds.regime.astype("i4") + 256), "regime must be one of .* got 258 at"),
    ("map", lambda ds: ds.assign(status=ds.status + 99), "status must be one of 0, 1, 2.*; got"),
    ("map", lambda ds: ds.assign(also_reachable=ds.also_reachable + 16), "must be a sum of 1, 2, 4, 8; got"),
    ("map", lambda ds: ds.assign(period=ds.period - 9), "period must be whole, >= 0; got -"),
    ("map", lambda ds: ds.assign(stops_per_cycle=-1 - ds.stops_per_cycle), "finite, >= 0 or NaN; got -1"),
    ("map", lambda ds: ds.assign(stops_per_cycle=ds.stops_per_cycle + np.inf), "or NaN; got inf"),
    ("map", lambda ds: ds.assign(stuck_fraction=ds.stuck_fraction + 1), "finite, >= 0, <= 1 or NaN; got"),
    ("map", lambda ds: ds.assign(beta_lim=ds.beta_lim * np.nan), "beta_lim must be a number, >= 0; got nan"),
    ("map", lambda ds: ds.assign(regime=ds.regime == 1), "regime must be numbers; got type bool"),
    ("map", lambda ds: ds.assign(beta_lim=ds.beta_lim * 1j), "beta_lim must be numbers; got type complex128"),
    ("map", lambda ds: ds.assign_attrs(title=3.0), "the attribute title must be text; got 3.0"),
    ("map", lambda ds: ds[[]], "no frictionmap variable found"),
    ("map", lambda ds: ds.regime, "ds must be an xarray.Dataset; got DataArray"),
    ("map", lambda ds: None, "ds must be an xarray.Dataset; got NoneType"),
    ("response", lambda ds: ds.drop_vars("mu").expand_dims(mu=[1.0, 2.0]), "must be one number .*mu"),
    ("response", lambda ds: ds.drop_vars("beta"), "beta must be a coordinate; got no such coordinate"),
    ("response", lambda ds: ds.assign(phase=ds.phase * 2), "phase must be one of -1, 0, 1; got"),
    ("response", lambda ds: ds.assign(x=ds.x / 0), "x must be finite; got"),
    ("boundaries", lambda ds: ds.assign(natural_frequency=-ds.natural_frequency), "finite, >= 0; got -"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "change", "message"), REFUSED)
def test_what_makes_no_sense_is_refused_in_one_line(datasets, kind, change, message):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        wrong = change(datasets[kind])
    with pytest.raises(InputError, match=message) as caught:
        standard_form(wrong)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "attributes", "message"),
    [
        ("r", {"units": "Hz"}, "r must have the units '1'; got 'Hz'"),
        ("beta_lim", {"units": 3}, "beta_lim must have the units '1'; got 3"),
        ("regime", {"flag_values": [2, 1, 0, -1]}, "regime must have the codes -1 unresolved, 0 perm"),
        ("regime", {"flag_values": [0, 1]}, "regime must have the codes"),
        ("regime", {"flag_meanings": "a b c d"}, "regime must have the codes .* a b c d"),
        ("also_reachable", {"flag_masks": [1, 2, 3]}, "also_reachable must have the codes 1 perm"),
    ],
)
def test_units_and_codes_are_those_that_the_values_are_read_by(datasets, name, attributes, message):
    ds = datasets["map"].copy()
    ds[name] = ds[name].assign_attrs(attributes)
    with pytest.raises(InputError, match=message):
        standard_form(ds)


def test_fewer_codes_and_no_attributes_are_well(datasets):
    """Files of former versions know fewer causes; arithmetic drops attributes."""
    ds = datasets["map"].copy()
    flags = {"flag_values": np.array([0, 1], "i1"), "flag_meanings": "resolved not_reached"}
    ds["status"] = ds["status"].assign_attrs(flags)
    xr.testing.assert_identical(standard_form(ds), datasets["map"])
    xr.testing.assert_identical(standard_form(ds.drop_attrs().assign_attrs(ds.attrs)), datasets["map"])


def test_codes_have_no_gaps():
    """The check of codes looks at the ends only."""
    for label in LABELS.values():
        values = [code.value for code in label.codes]
        step = [1 << k for k in range(len(values))] if label.flags == "flag_masks" else None
        assert values == (step or list(range(min(values, default=0), max(values, default=-1) + 1)))


def test_the_file_and_the_variable_are_named(datasets, tmp_path):
    path = tmp_path / "wrong.nc"
    datasets["map"].assign_coords(mu=[0.5, 1.0]).to_netcdf(path)
    with pytest.raises(
        InputError, match=rf"^file {re.escape(str(path))}: mu must be finite, >= 1; got 0.5 at"
    ):
        read(path)


def test_a_huge_variable_is_refused_before_it_is_read(tmp_path):
    """10^12 values that take no room in the file, and all memory if they were read."""
    import netCDF4

    path = tmp_path / "huge.nc"
    with netCDF4.Dataset(path, "w") as raw:
        raw.source = "frictionmap 1"
        raw.createDimension("r", 10**6)
        raw.createDimension("beta", 10**6)
        raw.createVariable("regime", "i1", ("r", "beta"), chunksizes=(1000, 1000), zlib=True)
    with pytest.raises(
        InputError, match=r"huge\.nc: regime must have at most 1e\+09 values in memory; got 1e\+12"
    ):
        read(path)


def test_contacts_peaks_and_phases_that_are_not_there(datasets):
    """Files that were read once and failed later."""
    system = fm.System(damping_ratios=0.1)
    two = fm.System(
        mass_ratios=[1, 1], stiffness_ratios=[1, 1], damping_ratios=0.1,
        contacts=[fm.Contact("fixed-wall", 1), fm.Contact("fixed-wall", 2)],
    )  # fmt: skip
    ds = fm.sweep(two, [0.5, 1.5], [0.1, 0.2])
    for wrong, message in (
        (ds.drop_vars("contact"), "contact must be a coordinate with one number per contact; got none"),
        (ds.assign_coords(contact=[7, 7]), "contact must be a coordinate .* got \\[7, 7\\]"),
        (datasets["response"].assign_coords(tau=datasets["response"].tau * 1e300), "tau must be "),
        (
            fm.design.least_peak(system, [0.5, 1.5]).isel(peak=slice(0, 0)),
            "peak must have at least one value",
        ),
    ):
        with pytest.raises(InputError, match=message):
            standard_form(wrong)


# Damaged at random


@pytest.mark.parametrize("family", [malformed.STRUCTURE, malformed.VALUES])
@pytest.mark.parametrize("kind", KINDS)
def test_malformed_files_are_read_or_refused(files, kind, family):
    """Other names, dimensions, types, attributes or values: well, or one line that names the file."""
    assert 1 < refused(files[kind], family, 15) < 15


@pytest.mark.parametrize("kind", KINDS)
def test_a_flipped_bit_of_an_axis_is_seen(datasets, files, kind, tmp_path):
    """Where the axis lies in the file it is not compressed; a changed value may well be a valid one."""
    content = files[kind].read_bytes()
    axis = datasets[kind]["tau" if kind == "response" else "r"].values.tobytes()
    place = content.index(axis)
    path = tmp_path / "flipped.nc"
    for bit in np.random.default_rng(1).integers(8 * len(axis), size=20):
        flipped = bytearray(content)
        flipped[place + bit // 8] ^= 1 << bit % 8
        path.write_bytes(flipped)
        with pytest.raises(InputError, match=r"flipped\.nc: it is damaged or not NetCDF"):
            read(path)
