"""What helps to begin: `init`, `schema`, `completion`; they say what the checks of the program say."""

import json
import re
import shlex
import shutil
import subprocess
import tomllib
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
import shtab
import xarray as xr
from conftest import ROOT
from hypothesis import given
from hypothesis import strategies as st
from test_cli import BAD_CONFIGURATIONS, listing, toml

from frictionmap import InputError, load_config
from frictionmap.command_line.arguments import (
    CONTACTS,
    FIGURE,
    QUANTITIES,
    RIGS,
    SHELLS,
    build_parser,
    described,
    subcommands,
)
from frictionmap.command_line.cli import _explore, main
from frictionmap.command_line.completion import completion
from frictionmap.datasets.labels import CELL_VARIABLES
from frictionmap.examples import starting_rig
from frictionmap.explorer.scene import scene_of
from frictionmap.files.json_schema import map_schema
from frictionmap.files.key import Key, whole
from frictionmap.files.keys import GENERAL_KEYS, KEYS
from frictionmap.files.special import SPECIAL, special_configuration
from frictionmap.files.template import SHORT, short_configuration, starting_configuration
from frictionmap.identify.parameters import Parameter
from frictionmap.identify.rigs.configuration import KINDS, identify, load_rig
from frictionmap.identify.rigs.keys import rig_keys, rig_schema, rig_settings
from frictionmap.identify.rigs.record import SYSTEM_KEYS as RECORD_SYSTEM
from frictionmap.identify.rigs.rig import LOSS, Kind
from frictionmap.identify.rigs.sweep import SYSTEM_KEYS as SWEEP_SYSTEM
from frictionmap.identify.tables.columns import pick_columns
from frictionmap.model import system
from frictionmap.pictures.curves.figure import CURVE_QUANTITIES
from frictionmap.pictures.options import FigureOptions

MAPS = sorted([*(ROOT / "configs").glob("*.toml"), *(ROOT / "configs" / "studies").glob("*.toml")])
RIG_FILES = sorted((ROOT / "configs" / "rigs").glob("*.toml"))
SCHEMA = jsonschema.Draft202012Validator(map_schema())
RIG_SCHEMA = jsonschema.Draft202012Validator(rig_schema())


def loaded(folder, text):
    path = folder / "map.toml"
    path.write_text(text, encoding="utf-8")
    return load_config(path)


def same(one, other):
    axes = ("r", "beta", "mu")
    return (one.system, one.solver, one.curves) == (other.system, other.solver, other.curves) and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in axes
    )


# init


#: Options of `init`, and those with which a coarse grid takes seconds.
TEMPLATES = [
    *(["--contact", contact] for contact in CONTACTS),
    ["--contacts"], ["--elastic"], ["--belt"], ["--design"],
]  # fmt: skip
COARSE = {"--units": "grid.r.step=12 Hz", "--ratios": "grid.r.step=0.7", "--full": "grid.r.step=0.9"}
TEMPLATES = [
    ([*kind, numbers], COARSE[numbers]) for kind in TEMPLATES for numbers in ("--units", "--ratios")
] + [
    (["--contact", contact, "--full", *more], COARSE["--full"])
    for contact in CONTACTS
    for more in ([], ["--units"])
]


@pytest.mark.parametrize(("options", "coarse"), TEMPLATES, ids=lambda value: str(value).strip("[]"))
def test_every_template_runs_with_every_command(options, coarse, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["init", *options, "--quiet"]) == 0
    text = (tmp_path / "map.toml").read_text(encoding="utf-8")
    SCHEMA.validate(tomllib.loads(text))
    assert "--full" in options or len(text.splitlines()) <= 22
    few = ["--set", coarse, "--set", "grid.beta.num=2", "--quiet"]
    for command in ("map", "curves", "boundaries", "design"):
        assert main([command, "map.toml", *few, "-o", f"{command}.nc"]) == 0, capsys.readouterr().err
        assert main(["plot", f"{command}.nc", "--quiet"]) == 0, capsys.readouterr().err
        assert main(["info", f"{command}.nc"]) == 0
    shown = re.search("^# frictionmap response map.toml (.*)$", text, re.MULTILINE)
    cell = shlex.split(shown[1]) if shown else ["--r", "0.6", "--beta", "0.3"]
    assert main(["response", "map.toml", *cell, "--quiet"]) == 0, capsys.readouterr().err
    assert main(["plot", "map-response.nc", "--quiet"]) == 0
    assert scene_of(load_config("map.toml")).sliders


def test_templates_of_the_command_line_are_all_of_them():
    actions = subcommands(build_parser()).choices["init"]._actions
    kinds = {one.const for one in actions if one.dest == "template"}
    assert {*CONTACTS, *kinds} == {*SHORT, *SPECIAL, "design", "history"}


@pytest.mark.parametrize("numbers", ["--units", "--ratios"])
@pytest.mark.parametrize("kind", SPECIAL)
def test_special_templates_run_with_the_commands_that_they_name(kind, numbers, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["init", f"--{kind}", numbers, "--quiet"]) == 0
    text = (tmp_path / "map.toml").read_text(encoding="utf-8")
    tree = tomllib.loads(text)
    SCHEMA.validate(tree)
    assert len(text.splitlines()) <= 28
    few = ["--set", "grid.beta.num=2", "--quiet"]
    for key in ("r", "wall_speed"):
        if key in tree["grid"]:
            ends = [tree["grid"][key][end] for end in ("start", "stop")]
            few += ["--set", f"grid.{key}={json.dumps(ends)}"]
    commands = re.search("also (.*)$", text, re.MULTILINE)[1].split(", ")
    for command in ("map", *commands):
        more = [] if command == "design" else few
        assert main([command, "map.toml", *more, "-o", f"{command}.nc"]) == 0, capsys.readouterr().err
        if command != "boundaries" or kind not in ("law", "squeal"):  # these limits have no picture
            assert main(["plot", f"{command}.nc", "--quiet"]) == 0, capsys.readouterr().err
        assert main(["info", f"{command}.nc"]) == 0
    cell = shlex.split(re.search("^# frictionmap response map.toml (.*)$", text, re.MULTILINE)[1])
    assert main(["response", "map.toml", *cell, "--quiet"]) == 0, capsys.readouterr().err
    assert main(["plot", "map-response.nc", "--quiet"]) == 0


@pytest.mark.parametrize("kind", ["normal", "backlash", "ring"])
def test_units_and_ratios_of_a_special_template_are_one_system(kind, tmp_path):
    one, other = (loaded(tmp_path, special_configuration("map", kind, numbers)) for numbers in (True, False))
    assert one.system == other.system
    np.testing.assert_allclose(one.beta, other.beta, rtol=1e-15)


@pytest.mark.parametrize("numbers", ["--units", "--ratios"])
def test_the_template_of_motions_runs_with_both_commands(numbers, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["init", "--history", numbers]) == 0
    assert "next: frictionmap history map.toml" in capsys.readouterr().out
    text = (tmp_path / "map.toml").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 18
    for command in ("history", "spectrum"):
        assert main([command, "map.toml"]) == 0, capsys.readouterr().err
        said = capsys.readouterr().out
        assert "remark" not in said
        assert "ringing" not in said  # both motions come to rest
        if numbers == "--units" and command == "history":
            assert re.search(
                r"half-sine, 19.6 N +largest displacement \S+ mm; stops \d+; rests at -?\S+ (mm|um)", said
            )
        assert main(["plot", f"map-{command}.nc", "--quiet"]) == 0


@pytest.mark.parametrize("numbers", ["--units", "--ratios"])
@pytest.mark.parametrize("kind", ["modes", "beam"])
def test_motions_in_time_of_modes_are_in_the_comments(kind, numbers, tmp_path, monkeypatch, capsys):
    """Without their signs these lines run as they stand; the points have their names in the picture."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", f"--{kind}", numbers, "--quiet"]) == 0
    text = (tmp_path / "map.toml").read_text(encoding="utf-8")
    comments = re.search(r"^#\[record\].*", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "map.toml").write_text(
        text[: comments.start()] + re.sub("^#", "", comments[0], flags=re.MULTILINE), encoding="utf-8"
    )
    assert main(["history", "map.toml"]) == 0, capsys.readouterr().err
    assert capsys.readouterr().out.count("largest displacement") == 2
    assert main(["plot", "map-history.nc", "--quiet"]) == 0
    assert loaded(tmp_path, (tmp_path / "map.toml").read_text(encoding="utf-8")).r.size > 1  # still a map


@pytest.mark.parametrize("kind", SHORT)
def test_units_and_ratios_of_a_template_are_one_system(kind, tmp_path):
    """Every ratio is exact, but that of the belt, a round number of each."""
    one, other = (loaded(tmp_path, short_configuration("map", kind, numbers)) for numbers in (True, False))
    assert one.system.wall_speed == pytest.approx(other.system.wall_speed, rel=0.01)
    assert replace(one.system, wall_speed=other.system.wall_speed) == other.system
    np.testing.assert_allclose(one.beta, other.beta, rtol=1e-15)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--belt", "--full"], "cannot use --belt with --full: it is for a short configuration of a map"),
        (["--rig", "sweep", "--ratios"], "cannot use --ratios with --rig: it is for a short configuration"),
    ],
)  # fmt: skip
def test_options_that_exclude_each_other(options, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["init", *options]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_explore_without_a_file_opens_a_preset(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shown = []
    monkeypatch.setattr(
        "frictionmap.explorer.server.open_server", lambda scene, port: shown.append(scene) or 1 / 0
    )
    with pytest.raises(ZeroDivisionError):
        _explore(build_parser().parse_args(["explore"]))
    assert shown[0].title == "One mass on a fixed wall"
    assert main(["explore", "--set", "grid.r=1"]) == 2
    assert "cannot use --set without CONFIG.toml" in capsys.readouterr().err


@pytest.mark.parametrize("kind", RIGS)
def test_a_short_rig_runs_as_it_stands(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["init", "--rig", kind]) == 0
    text = (tmp_path / "rig.toml").read_text()
    assert len(text.splitlines()) <= 16
    RIG_SCHEMA.validate(tomllib.loads(text))
    assert load_rig("rig.toml")._replace(title="", text="", name="", file="", files=()) == load_rig(
        ROOT / "configs" / "rigs" / f"{kind}.toml"
    )._replace(title="", text="", name="", file="", files=())


@pytest.mark.parametrize("contact", CONTACTS)
def test_a_configuration_to_begin_with_runs_as_it_stands(contact, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["init", "--full", "--contact", contact]) == 0
    told = capsys.readouterr().out
    then = "frictionmap explore map.toml, or frictionmap map map.toml && frictionmap plot map.nc"
    assert told == f"wrote map.toml; next: {then}\n"
    assert load_config("map.toml").system.contact == contact
    coarse = ["--set", "grid.r.step=0.31", "--set", "grid.beta.num=4"]  # seconds of it, not all
    assert main(["map", "map.toml", *coarse]) == 0
    assert main(["plot", "map.nc"]) == 0


@pytest.mark.parametrize("contact", CONTACTS)
def test_every_key_is_there_once_and_shows_its_default(contact, tmp_path):
    text = starting_configuration("map", contact)
    before = loaded(tmp_path, text)
    for section, keys in KEYS.items():
        start = text.index(f"[{section}]\n") if section else 0
        for key in keys:
            (line,) = re.findall(rf"^#?{key.name} = .*$", text[start:].split("\n[")[0], re.MULTILINE)
            if line.startswith("#") and key.default is not None and key.name not in ("stiffness_scale",):
                head, tail = text[:start], text[start:]
                assert same(loaded(tmp_path, head + tail.replace(line, line[1:], 1)), before), line


def test_valid_values_stand_above_each_key():
    text = starting_configuration("map")
    for keys in KEYS.values():
        for key in keys:
            assert re.search(rf"^# .*\n(?:#   .*\n)+#?{key.name} = ", text, re.MULTILINE), key.name


@pytest.mark.parametrize("kind", RIGS)
def test_a_rig_to_begin_with_runs_as_it_stands(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["init", "--full", "--rig", kind]) == 0
    assert sorted(listing(tmp_path)) == sorted(["rig.toml", f"{kind}.csv"])
    committed = ROOT / "configs" / "rigs" / f"{kind}.csv"
    assert (tmp_path / f"{kind}.csv").read_text() == committed.read_text()
    assert load_rig("rig.toml")._replace(title="", text="", name="", file="", files=()) == load_rig(
        committed.with_suffix(".toml")
    )._replace(title="", text="", name="", file="", files=())


def test_nothing_is_overwritten_unasked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text("mine")
    (tmp_path / "free-decay.csv").write_text("mine")
    before = listing(tmp_path)
    assert main(["init", "mine.toml"]) == 2
    assert main(["init", "--rig", "free-decay"]) == 2  # its data are there, so not even rig.toml is written
    assert main(["init", "mine.txt"]) == 2
    assert main(["init", "nowhere/map.toml"]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert errors == [
        "frictionmap: cannot write mine.toml: it already exists; use --overwrite or another NAME.toml",
        "frictionmap: cannot write free-decay.csv: it already exists; use --overwrite or another NAME.toml",
        "frictionmap: NAME.toml must end in .toml; got mine.txt",
        "frictionmap: NAME.toml must be in an existing folder; got nowhere/map.toml",
    ]
    assert listing(tmp_path) == before
    assert main(["init", "mine.toml", "--overwrite", "--quiet"]) == 0
    assert load_config("mine.toml")
    assert capsys.readouterr().out == ""


def test_words_of_the_command_line_are_those_of_the_program():
    assert CONTACTS == system.CONTACTS
    assert tuple(KINDS) == RIGS
    assert set(shtab.SUPPORTED_SHELLS) >= set(SHELLS)
    of_maps = QUANTITIES[QUANTITIES.index("regimes") + 1 :]
    assert (*CURVE_QUANTITIES, "history", "orbit", "regimes", *of_maps) == QUANTITIES
    assert all(not CELL_VARIABLES[name].codes for name in of_maps)
    assert FigureOptions.__annotations__.keys() == set(FIGURE)


# schema


@pytest.mark.parametrize("path", MAPS, ids=lambda path: path.stem)
def test_every_committed_configuration_obeys_the_schema(path):
    SCHEMA.validate(tomllib.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("path", RIG_FILES, ids=lambda path: path.stem)
def test_every_committed_rig_obeys_the_schema(path):
    RIG_SCHEMA.validate(tomllib.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("contact", CONTACTS)
def test_what_init_writes_obeys_the_schema(contact):
    SCHEMA.validate(tomllib.loads(starting_configuration("map", contact)))


@pytest.mark.parametrize(
    "system",
    [
        'matrices = "plate.pch"\ncontact_masses = ["112.1"]\nload_mass = "7.3"',
        'matrices = { M = "m.mtx", K = "k.mtx" }\ncontact_masses = [3]',
        "matrices = { M = [[1.0]], K = [[2]], C = [[0.1]], dofs = [7] }\nfrequency_scale = 2.0",
        "load = [1.0, [0.5, 0.2]]\nmass_ratios = [1, 2]\nstiffness_ratios = [1, 2]",
    ],
)
def test_good_systems_obey_the_schema(system):
    SCHEMA.validate(tomllib.loads(toml(system=system)))


@pytest.mark.parametrize("base", ["1 um", "1 \u00b5m", "1\u03bcm", "0.5 in"])
def test_units_however_they_are_written_obey_the_schema(base, tmp_path):
    text = toml(top=f'[units]\nbase_amplitude = "{base}"', system='excitation = "base"')
    SCHEMA.validate(tomllib.loads(text))
    assert loaded(tmp_path, text).units.base_amplitude == base


@pytest.mark.parametrize("kind", RIGS)
def test_rigs_that_init_writes_obey_the_schema(kind):
    RIG_SCHEMA.validate(tomllib.loads(starting_rig(kind)[0]))


@pytest.mark.parametrize("kind", RIGS)
def test_a_template_does_not_name_the_data_that_take_its_place(kind, tmp_path, monkeypatch):
    """Pictures of measured data are called after their file, not after the synthetic data of the template."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", "--rig", kind, "--quiet"]) == 0
    (tmp_path / f"{kind}.csv").rename(tmp_path / "storey-7.csv")
    config = tmp_path / "rig.toml"
    config.write_text(config.read_text().replace(f"{kind}.csv", "storey-7.csv"))
    rig = load_rig(config)
    assert rig.title == "storey-7"
    assert "title" not in tomllib.loads(config.read_text())
    assert "synthetic" not in rig.text.lower()


#: What a schema cannot say, beside what is no TOML at all: these it takes, and the program refuses.
BEYOND = {
    "not TOML", "TOML with a key given twice", "brackets without end", "a number of thousands of digits",
    "zeta not finite", "nan in an axis", "inf in an axis", "inf for an axis", "nan as a start",
    "an integer beyond all doubles", "unsorted axis", "a value twice", "stop < start",
    "springs and masses differ", "between masses, of one", "a second mass in contact",
    "a load on a second mass", "matrices that are not there", "a damping ratio too many",
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(set(BAD_CONFIGURATIONS) - BEYOND))
def test_bad_configurations_break_the_schema(name):
    with pytest.raises(jsonschema.ValidationError):
        SCHEMA.validate(tomllib.loads(BAD_CONFIGURATIONS[name][0]))


@pytest.mark.parametrize(
    "text",
    [
        toml(top="[axes]\ndamping = [0.1]"),
        toml(top="[axes]\nsample = { file = 5 }"),
        toml(top="[axes]"),
        toml(top="[curves]\nharmonics = -1"),
        toml(top='[curves]\nquantities = ["amplitud"]'),
        toml(system='contact = "joined-base-wall"\nexcitation = "force"'),
        toml(system='damping_reference = "base"'),
        toml(system="frequency_scale = 2.0"),
        toml(system="load = [1.0]\nload_mass = 1"),
        toml(system="load = [[1.0, 2.0, 3.0]]"),
        toml(system='contact_masses = ["112.1"]'),
        toml(system='matrices = { M = "m.mtx", K = [[1]] }'),
        toml(system="mass_ratios = [1]\nmatrices = { M = [[1]], K = [[1]] }"),
    ],
)
def test_the_program_and_the_schema_refuse_alike(text, tmp_path):
    with pytest.raises(jsonschema.ValidationError):
        SCHEMA.validate(tomllib.loads(text))
    with pytest.raises(InputError):
        loaded(tmp_path, text)


#: Values at the ends of ranges and just beyond, and some that are far off.
NUMBERS = st.sampled_from(
    [-1, -1e-300, 0, 1e-300, 1e-15, 0.9e-15, 1e-3, 1.1e-3, 0.5, 1, 2, 24, 99.9, 100, 100.1, 1000, 1001, 10**9]
) | st.floats(-2.0, 2.0)


@given(key=st.sampled_from([("solver", "cycles"), ("solver", "tolerance"), ("solver", "steps"),
                            ("curves", "harmonics"), ("system", "damping_ratios"), ("grid", "beta"),
                            ("grid", "mu"), ("grid", "r")]), value=NUMBERS)  # fmt: skip
def test_ranges_are_the_same_in_both(key, value, tmp_path_factory):
    section, name = key
    tables = {"system": {}, "grid": {"r": 1.0, "beta": 1.0}, "solver": {}, "curves": {}}
    tables[section][name] = int(value) if value == int(value) else value  # JSON has one kind of 9 and 9.0
    text = "\n".join(
        line
        for title, table in tables.items()
        for line in (f"[{title}]", *(f"{key} = {one!r}" for key, one in table.items()))
    )
    try:
        loaded(tmp_path_factory.getbasetemp(), text)
        taken = True
    except InputError:
        taken = False
    assert SCHEMA.is_valid(tomllib.loads(text)) == taken, text


@pytest.mark.parametrize("kind", KINDS)
def test_keys_of_rigs_are_those_of_their_kinds(kind):
    tables = {name: [key.name for key in keys] for name, keys in rig_keys(kind).items()}
    of = KINDS[kind]
    data = ("kind", "file", "columns", "decimal", "missing", *(key.name for key in of.data))
    assert tables["data"] == [*data]
    assert set(tables["known"]) == {*of.parameters, *of.known, *(key.name for key in of.lists)}
    assert set(tables.get("fit", ())) == {*(key.name for key in of.fit), *(["free"] if of.parameters else [])}
    systems = {
        "record": RECORD_SYSTEM,
        "sweep": SWEEP_SYSTEM,
        "forced": [*(key.name for key in KEYS["system"] if key not in GENERAL_KEYS), "contact_stiffness"],
    }
    assert set(tables.get("system", ())) == set(systems.get(kind, ()))
    assert bool(of.system) == ("system" in tables)


def test_a_kind_of_data_is_added_by_its_record_alone(tmp_path, monkeypatch):
    """Schema, keys, settings, units and checks of its configurations follow from the record."""

    def fit(rig, table):
        columns = pick_columns(table, {"force": "force"}, rig.columns).columns
        scale = rig.known["friction"] * rig.data["turns"]
        return xr.Dataset({"total": scale * columns["force"].values.sum()}, attrs={"warnings": ""})

    friction = Parameter("friction force, N", "2.0", "N", {"least": 0.0})
    turns = Key("turns", "turns to be fitted", whole(least=1), example="3")
    monkeypatch.setitem(KINDS, "loop", Kind(fit, {"friction": friction}, data=(turns,), fit=(LOSS,)))
    (tmp_path / "loop.csv").write_text("time_s,force_N\n0.0,1.0\n0.1,2.5\n")
    text = '[data]\nkind = "loop"\nfile = "loop.csv"\nturns = 2\n[known]\nfriction = "2 kN"\n'
    (tmp_path / "loop.toml").write_text(text)
    assert identify(load_rig(tmp_path / "loop.toml"))["total"].item() == 2000.0 * 2 * 3.5
    assert jsonschema.Draft202012Validator(rig_schema()).is_valid(tomllib.loads(text))
    assert not jsonschema.Draft202012Validator(rig_schema()).is_valid(
        tomllib.loads(text.replace("= 2", "= 0"))
    )
    assert {"data.turns", "known.friction", "fit.loss"} <= set(rig_settings())
    (tmp_path / "loop.toml").write_text(text.replace("turns", "turn"))
    with pytest.raises(InputError, match=r"unknown key 'data\.turn' \(did you mean turns\?\)"):
        load_rig(tmp_path / "loop.toml")


@pytest.mark.parametrize(
    "text",
    [
        '[data]\nkind = "decay"\nfile = "a.csv"',
        '[data]\nkind = "sweep"\n[system]\nmasses = 2',
        '[data]\nkind = "sweep"\nfile = "a.csv"',
        '[data]\nkind = "sweep"\nfile = "a.csv"\nwindow = [0, 1]\n[system]\nmasses = 2',
        '[data]\nkind = "record"\nfile = "a.csv"\n[known]\nX0 = 1.0',
        '[data]\nkind = "free-decay"\nfile = "a.csv"\n[known]\nx_F = "1"',
    ],
)
def test_bad_rigs_break_the_schema(text):
    assert not RIG_SCHEMA.is_valid(tomllib.loads(text))


@pytest.mark.parametrize(("arguments", "schema"), [([], map_schema), (["--rig"], rig_schema)])
def test_the_schema_is_printed_and_is_a_schema(arguments, schema, capsys):
    assert main(["schema", *arguments]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == schema()
    jsonschema.Draft202012Validator.check_schema(printed)


# completion


def bash(words, folder):
    """What bash offers in place of the last of these words."""
    quoted = " ".join(f"'{word}'" for word in words)
    script = f"""
        eval "$(cat completion)"
        compopt() {{ :; }}
        COMP_WORDS=(frictionmap {quoted}); COMP_CWORD={len(words)}
        _frictionmap; printf '%s\\n' "${{COMPREPLY[@]}}"
    """
    return offered(["bash", "-c", script], folder)


def fish(words, folder):
    """What fish offers."""
    line = " ".join(["frictionmap", *words])
    found = offered(["fish", "-c", f'source completion; complete -C "{line}"'], folder)
    return {one.split("\t")[0] for one in found}


def offered(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600, check=True)
    assert done.stderr == ""
    return set(done.stdout.splitlines()) - {""}


@pytest.mark.parametrize(("shell", "ask"), [("bash", bash), ("fish", fish)])
def test_completion(shell, ask, tmp_path, capsys):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    for name in ("one.toml", "map.nc", "other.txt"):
        (tmp_path / name).touch()
    (tmp_path / "folder").mkdir()
    assert main(["completion", shell]) == 0
    (tmp_path / "completion").write_text(capsys.readouterr().out)
    assert ask(["spec"], tmp_path) == {"spectrum"}
    assert ask(["bound"], tmp_path) <= {"bound"}  # an older name is not offered
    assert ask(["map", "--over"], tmp_path) == {"--overwrite"}
    assert ask(["init", "--contact", "f"], tmp_path) == {"fixed-wall"}
    assert ask(["map", "--set", "solver.st"], tmp_path) == {
        "solver.start=",
        "solver.steps=",
        "solver.steady=",
    }
    assert ask(["identify", "--set", "known.x_"], tmp_path) == {"known.x_F="}
    assert ask(["plot", "--quantity", "o"], tmp_path) == {"orbit"}
    assert ask(["plot", "--at", "damp"], tmp_path) == {"damping_ratios="}
    assert {one.rstrip("/") for one in ask(["map", ""], tmp_path)} == {"one.toml", "folder"}
    assert {one.rstrip("/") for one in ask(["plot", ""], tmp_path)} == {"map.nc", "folder"}


@pytest.mark.parametrize("shell", SHELLS)
def test_completion_is_a_script_of_its_shell_and_names_every_option(shell):
    script = completion(build_parser(), shell, {"": {"--set": ["grid.r="]}})
    for command in described():
        assert command.name in script
        for argument in command.arguments:
            for flag in argument.flags:
                assert (flag if shell not in ("fish", "tcsh") else flag.lstrip("-")) in script
    if shutil.which(shell):
        assert subprocess.run([shell, "-n", "-c", script], check=False).returncode == 0


def test_an_unknown_shell_is_refused(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["completion", "sh"])
    assert stop.value.code == 2
    assert "invalid choice: 'sh'" in capsys.readouterr().err
