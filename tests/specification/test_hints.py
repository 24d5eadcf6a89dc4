"""Hints of messages: outputs of a system in groups, frequent mistakes in TOML, options before a command."""

import tomllib

import pytest

import frictionmap as fm
from frictionmap.command_line.arguments import parse
from frictionmap.command_line.cli import main
from frictionmap.files.config import parse as parse_toml
from frictionmap.model.settings import GENERAL_OUTPUTS, OUTPUTS, describe_outputs
from frictionmap.solvers.choose import valid_outputs

GRID = "[grid]\nr = [0.5]\nbeta = [0.1]\n"
WITH_SPRING = "[system]\ncontact_stiffness = 2.0\n"


@pytest.mark.parametrize(
    ("system", "there", "not_there"),
    [
        ("[system]\n", ["stops_per_cycle", "multiplier", "base_force"], ["slips_per_cycle", "work_wall"]),
        (
            WITH_SPRING,
            ["slips_per_cycle", "least_slip"],
            ["stops_per_cycle", "asymmetry", "spring_force_max"],
        ),
    ],
)
def test_unknown_outputs_are_answered_with_those_of_the_system(system, there, not_there, tmp_path):
    path = tmp_path / "c.toml"
    path.write_text(f'{system}{GRID}[solver]\noutputs = ["regim"]\n')
    with pytest.raises(fm.InputError) as caught:
        fm.load_config(path)
    message = str(caught.value)
    assert message.startswith("solver.outputs must be some of (regime: regime, ")
    assert message.endswith("; got 'regim' (did you mean regime?)")
    listed = message.partition("(")[2].partition(")")[0]
    groups = dict(part.split(": ") for part in listed.split("; "))
    assert list(groups) == ["regime", "motion", "forces and energy", "diagnostics"]
    names = {name for group in groups.values() for name in group.split(", ")}
    assert names >= {*there}
    assert not names & {*not_there}


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [None, 2.0])
def test_outputs_that_are_listed_are_computed(stiffness):
    system = fm.System(contact_stiffness=stiffness, damping_ratios=0.1)
    for name in valid_outputs(system):
        assert name in fm.sweep(system, [0.5], [0.1], outputs=[name]), name


def test_every_output_is_listed_once():
    listed = describe_outputs((*OUTPUTS, *GENERAL_OUTPUTS)).split("; ")
    names = [name for group in listed for name in group.partition(": ")[2].split(", ")]
    assert sorted(names) == sorted({*OUTPUTS, *GENERAL_OUTPUTS})


@pytest.mark.parametrize(
    ("line", "remedy"),
    [
        ("damping_ratios = 0,05", "use a decimal point: 0.05"),
        ("r = { start = 0,5, stop = 2 }", "use a decimal point: 0.5"),
        ("contact = fixed-wall", 'put text in quotes: "fixed-wall"'),
        ("load = 100 N   # of mass 1", 'put a number with its unit in quotes: "100 N"'),
        ("r = { start = 4 Hz, stop = 9 }", 'put a number with its unit in quotes: "4 Hz"'),
        ("band = [4 Hz, 9 Hz]", 'put a number with its unit in quotes: "4 Hz"'),
        ('title = "A map', "close the quotation mark"),
        ("mu = ]", "correct the syntax"),
    ],
)
def test_mistakes_in_toml_are_answered_with_what_to_write(line, remedy):
    with pytest.raises(fm.InputError, match="cannot parse as TOML") as caught:
        parse_toml(f"[system]\n{line}\nzeta = 1\n")
    assert str(caught.value).endswith(f"; {remedy}")
    written = remedy.partition(": ")[2]
    if written:
        assert tomllib.loads(f"key = {written}")


@pytest.mark.parametrize("given", ["--verison", "--ver", "-v"])
def test_options_before_a_command(given, capsys):
    with pytest.raises(SystemExit) as ended:
        parse([given])
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert error.startswith(f"frictionmap: unknown option '{given}'")
    assert ("did you mean --version?" in error) == (given == "--verison" or "ver" in given)


def test_without_arguments_there_is_a_short_help(capsys):
    with pytest.raises(SystemExit) as ended:
        main([])
    assert ended.value.code == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "usage: frictionmap COMMAND ..."
    assert len(lines) < 12


def test_boundaries_alone_and_setup(tmp_path, monkeypatch, capsys):
    """They are what the older commands give."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.toml").write_text(f"[system]\n{GRID}")
    assert main(["map", "c.toml", "--boundaries-only", "-o", "new.nc"]) == 0
    assert main(["boundaries", "c.toml", "-o", "old.nc"]) == 0
    new, old = fm.open("new.nc"), fm.open("old.nc")
    assert new.drop_attrs().identical(old.drop_attrs())
    assert main(["map", "c.toml", "--boundaries-only", "--threads", "1"]) == 2
    assert main(["map", "c.toml", "--borders"]) == 2
    capsys.readouterr()
    for arguments in (["schema"], ["schema", "--rig"], ["completion", "bash"]):
        assert main(["setup", *arguments]) == main(arguments) == 0
        out = capsys.readouterr().out
        assert out[: len(out) // 2] == out[len(out) // 2 :]
