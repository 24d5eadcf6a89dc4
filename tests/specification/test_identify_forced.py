"""The command `identify` for forced responses: columns, sets, what is refused and what is warned of."""

import re

import numpy as np
import pytest
import xarray as xr
from refusals import refusal
from responses import Truth, table

import frictionmap as fm
from frictionmap.command_line.cli import main

TRUTH = Truth(3.0, 0.01, (0.2, 0.4), (0.65, 0.7, 0.9, 1.1, 1.4, 1.8))
SETS, FREQUENCY, LAG, RATIO = table(TRUTH, 1)
TWO = fm.System(mass_ratios=[1, 1], stiffness_ratios=[1, 1])
HEAD = "set,frequency_Hz,phase_lag_deg,amplitude_ratio,base_mm"
LINES = [f"{s},{f:.5f},{p:.5f},{x:.6f},1.5" for s, f, p, x in zip(SETS, FREQUENCY, LAG, RATIO, strict=True)]
RIG = """
[data]
kind = "forced"
file = "table.csv"
sigma_phase_deg = 0.7
sigma_amplitude = 0.01
[system]
contact = "fixed-wall"
excitation = "base"
damping_reference = "base"
[known]
mu = 1.0
"""


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Writes a data file and its configuration; the path of the latter."""
    monkeypatch.chdir(tmp_path)

    def write(lines=LINES, text=RIG, head=HEAD):
        (tmp_path / "table.csv").write_text("\n".join([head, *lines]) + "\n")
        (tmp_path / "rig.toml").write_text(text)
        return "rig.toml"

    return write


def columns(line, *kept):
    return ",".join(line.split(",")[k] for k in kept)


def test_from_a_file_to_friction_forces(rig, capsys):
    assert main(["identify", rig()]) == 0
    out = capsys.readouterr().out
    rows = {line.split()[0]: line.split() for line in out.splitlines() if line.split()}
    assert float(rows["beta_2"][1]) == pytest.approx(0.4, abs=0.02)
    (friction,) = re.findall(r"x_F_2 = (\S+) \+- \S+ mm \(95 %\)", out)
    assert float(friction) == pytest.approx(0.6, abs=0.03)
    assert out.count("x_F_2") == 1  # in the result, not again below the table
    assert rows["mu"][2] == "held"
    assert "friction and viscous damping found" in out
    assert "warning" not in out
    with xr.open_dataset("rig-identify.nc") as ds:
        lags = ds.quantity == 1
        np.testing.assert_allclose(ds.data[lags], LAG, atol=1e-5)
        np.testing.assert_allclose(ds.data[~lags], RATIO, rtol=1e-5)
        np.testing.assert_allclose((ds.model - ds.data)[lags], ds.residual[lags], atol=1e-9)
        np.testing.assert_allclose(np.log(ds.model / ds.data)[~lags], ds.residual[~lags], atol=1e-9)
        assert set(ds.set.values.tolist()) == {"1", "2"}
        assert (ds.sigma[lags] == 0.7).all()


def test_units_of_columns(rig):
    """Radians and rad/s are the same data."""
    assert main(["identify", rig(), "--quiet"]) == 0
    head = "set,frequency_rad_s,phase_lag_rad,amplitude_ratio"
    lines = [
        f"{s},{2.0 * np.pi * f:.6f},{np.radians(p):.7f},{x:.6f}"
        for s, f, p, x in zip(SETS, FREQUENCY, LAG, RATIO, strict=True)
    ]
    assert main(["identify", rig(lines, head=head), "--quiet", "-o", "other.nc"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds, xr.open_dataset("other.nc") as other:
        np.testing.assert_allclose(other.estimate, ds.estimate, rtol=1e-4)


def test_loads_that_differ_row_by_row(rig):
    """One friction force under bases of two sizes: beta is over their mean."""
    f = np.tile(np.array(TRUTH.r) * TRUTH.f_n, 2)
    once = [table(TRUTH._replace(beta=(beta,)), 3, 0.0, 0.0)[2:] for beta in (0.2, 0.4)]
    lag, ratio = np.concatenate(once, axis=1)
    base = np.repeat([2.0, 1.0], len(TRUTH.r))
    lines = [f"{a},{b},{c},{d}" for a, b, c, d in zip(f, lag, ratio, base, strict=True)]
    path = rig(lines, head="frequency_Hz,phase_lag_deg,amplitude_ratio,base_mm")
    assert main(["identify", path, "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        assert float(ds.estimate.sel(parameter="beta")) == pytest.approx(0.4 / 1.5, rel=1e-5)
        assert float(ds.x_F) == pytest.approx(0.4, rel=1e-5)


def test_errors_by_row_and_from_the_residuals(rig, capsys):
    lines = [f"{line},0.7,0.01" for line in LINES]
    own = RIG.replace("sigma_phase_deg = 0.7\nsigma_amplitude = 0.01\n", "")
    assert main(["identify", rig(), "--quiet"]) == 0
    path = rig(lines, own, f"{HEAD},sigma_phase_deg,sigma_amplitude")
    assert main(["identify", path, "--quiet", "-o", "rows.nc"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds, xr.open_dataset("rows.nc") as rows:
        np.testing.assert_allclose(rows.standard_error, ds.standard_error, rtol=1e-9)
    assert main(["identify", rig(text=own), "--quiet", "-o", "residuals.nc"]) == 0
    with xr.open_dataset("residuals.nc") as ds:
        assert ds.attrs["errors"] == "of lags from the residuals, of amplitudes from the residuals"
        assert 0.3 < float(ds.sigma[ds.quantity == 1][0]) < 1.2  # 12 lags of which the fit takes some
        assert float(ds.reduced_chi_square) == pytest.approx(1.0, abs=0.01)
    path = rig(lines, head=f"{HEAD},sigma_phase_deg,sigma_amplitude")
    assert "cannot use data.sigma_phase_deg" in refusal(capsys, "identify", path, "--overwrite")


def test_lags_alone_do_not_determine_the_frequency(rig, capsys):
    lines = [columns(line, 0, 1, 2) for line in LINES]
    head = "set,frequency_Hz,phase_lag_deg"
    assert main(["identify", rig(lines, RIG.replace("mu = 1.0", "mu = 1.0\nzeta = 0.01"), head)]) == 0
    out = capsys.readouterr().out
    assert "warning: phase data alone cannot determine f_n: it is held at" in out
    below = [line for line in lines if float(line.split(",")[2]) < 90.0]
    assert "cannot determine f_n: phase data alone do not determine it" in refusal(
        capsys, "identify", rig(below, head=head), "--overwrite"
    )


def test_no_stop_no_mu(rig, capsys):
    assert main(["identify", rig(text=RIG.replace("mu = 1.0", ""))]) == 0
    out = capsys.readouterr().out
    assert "warning: no fitted motion sticks: the data do not determine mu, which is held at 1" in out


@pytest.mark.slow
def test_lags_that_no_friction_gives(rig, capsys):
    """Refused by name; left out on request, with a warning."""
    lines = [*LINES, "2,5.8332,60,1.0,1.5"]
    known = RIG.replace("mu = 1.0", "mu = 1.0\nf_n = 3.0")
    for text in (known, RIG):
        message = refusal(capsys, "identify", rig(lines, text))
        assert "no friction ratio gives a lag of 60 deg at r = 1.9" in message
        assert "above resonance it is 90 to 180 deg; use unreachable" in message
    path = rig(
        lines, RIG.replace("sigma_amp", 'unreachable = "drop"\nuse = ["phase", "amplitude"]\nsigma_amp')
    )
    assert main(["identify", path]) == 0
    assert "warning: 1 lag ignored: no friction ratio gives such a lag" in capsys.readouterr().out


def test_each_lag_determines_the_friction(rig):
    assert main(["identify", rig(), "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        own = ds.isel(sample=ds.lag_sample.values)
        pull = (ds.lag_friction_ratio.values - own.friction_ratio.values) / ds.lag_friction_ratio_error.values
        assert ds.sizes["answer"] == 12
        assert np.abs(pull).max() < 4.0
        assert (ds.lag_status == 4).sum() == 12  # amplitudes


def test_sets_by_any_name(rig):
    lines = [line.replace("1,", "loose,", 1) if line[0] == "1" else f"b{line}" for line in LINES]
    assert main(["identify", rig(lines), "--quiet"]) == 0
    with xr.open_dataset("rig-identify.nc") as ds:
        assert ds.parameter.values.tolist() == ["beta_loose", "beta_b2", "f_n", "zeta", "mu"]


def without_column(lines, head, k):
    names = head.split(",")
    kept = [index for index in range(len(names)) if index != k]
    return [columns(line, *kept) for line in lines], columns(head, *kept)


def estimates_of(path):
    with xr.open_dataset(path) as ds:
        return ds.load()


def test_columns_that_nobody_asked_for(rig, capsys):
    """A frequency that begins like a base is none, mapped or not; columns left alone are named."""
    assert main(["identify", rig(), "--quiet"]) == 0
    capsys.readouterr()
    lines = [f"{line},{2.0 * np.pi * f:.8f},a,7" for line, f in zip(LINES, FREQUENCY, strict=True)]
    head = f"{HEAD},base_frequency_rad_s,note,base_inch"
    for k, (text, left) in enumerate([
        (RIG, "base_frequency_rad_s, note, base_inch"),
        (RIG.replace("sigma_p", "columns = { frequency = 'base_frequency_rad_s' }\nsigma_p"),
         "frequency_Hz, note, base_inch"),
    ]):  # fmt: skip
        assert main(["identify", rig(lines, text, head), "-o", f"{k}.nc"]) == 0
        assert f"columns of table.csv that are not used: {left}\n" in capsys.readouterr().out
        np.testing.assert_allclose(
            estimates_of(f"{k}.nc").estimate, estimates_of("rig-identify.nc").estimate, rtol=1e-4
        )


def test_no_base_but_a_frequency_that_begins_like_one(rig):
    lines, head = without_column(LINES, HEAD, 4)
    lines = [f"{line},{2.0 * np.pi * f:.8f}" for line, f in zip(lines, FREQUENCY, strict=True)]
    text = RIG.replace("sigma_p", "columns = { frequency = 'base_frequency_rad_s' }\nsigma_p")
    head = head.replace("frequency_Hz", "f") + ",base_frequency_rad_s"
    assert main(["identify", rig(lines, text, head), "--quiet"]) == 0


def test_what_data_use_leaves_out_is_not_named(rig, capsys):
    text = RIG.replace("sigma_p", 'use = ["amplitude"]\nsigma_p')
    assert main(["identify", rig(text=text)]) == 0
    assert "that are not used" not in capsys.readouterr().out


def test_a_measured_frequency_goes_before_its_ratio(rig):
    """A column frequency_ratio beside it asks for no known f_n."""
    lines = [f"{line},{f / 3.0}" for line, f in zip(LINES, FREQUENCY, strict=True)]
    assert main(["identify", rig(lines, head=f"{HEAD},frequency_ratio"), "--quiet"]) == 0


def test_the_load_of_the_other_excitation_with_its_own(rig, capsys):
    lines = [f"{line},3.0" for line in LINES]
    assert main(["identify", rig(lines, head=f"{HEAD},force_N")]) == 0
    assert "columns of table.csv that are not used: force_N" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("unit", "order", "size"),
    [("mm_s", 1, 1.0), ("m_s", 1, 1e3), ("m_s2", 2, 1e3), ("mm_s2", 2, 1.0), ("g", 2, 9806.65)],
)
def test_accelerations_and_velocities_of_base_and_mass(rig, unit, order, size):
    """x_F is that of the displacements: amplitudes over omega or its square."""
    assert main(["identify", rig(), "--quiet"]) == 0
    true = estimates_of("rig-identify.nc")
    rate = (2.0 * np.pi * FREQUENCY) ** order / size
    lines, _ = without_column(LINES, HEAD, 4)
    lines = [f"{line},{1.5 * w:.9g}" for line, w in zip(lines, rate, strict=True)]
    head = HEAD.replace("base_mm", f"base_{unit}")
    assert main(["identify", rig(lines, head=head), "--quiet", "-o", "base.nc"]) == 0
    lines = [
        f"{s},{f:.5f},{p:.5f},{1.5 * w:.9g},{x * 1.5:.9g}"
        for s, f, p, x, w in zip(SETS, FREQUENCY, LAG, RATIO, rate, strict=True)
    ]
    head = f"set,frequency_Hz,phase_lag_deg,base_{unit},x_mm"
    assert main(["identify", rig(lines, head=head), "--quiet", "-o", "mixed.nc"]) == 0
    lines = [
        f"{s},{f:.5f},{p:.5f},1.5,{x * 1.5 * w:.9g}"
        for s, f, p, x, w in zip(SETS, FREQUENCY, LAG, RATIO, rate, strict=True)
    ]
    head = f"set,frequency_Hz,phase_lag_deg,base_mm,x_{unit}"
    assert main(["identify", rig(lines, head=head), "--quiet", "-o", "mass.nc"]) == 0
    for name in ("base.nc", "mixed.nc", "mass.nc"):
        found = estimates_of(name)
        np.testing.assert_allclose(found.estimate, true.estimate, rtol=2e-4)
        assert float(found.x_F_1) == pytest.approx(float(true.x_F_1), rel=2e-4)
        assert found.x_F_1.attrs["units"] == "mm"


def test_friction_in_newtons(rig, capsys):
    """k1 beta Y of every set, with its error."""
    text = RIG.replace("mu = 1.0", 'mu = 1.0\nstiffness = "2 N/mm"')
    assert main(["identify", rig(text=text), "--verbose"]) == 0
    printed = capsys.readouterr().out
    assert "friction_force_2  " in printed
    assert re.search(r"F_2 = 1\.\d+ \+- 0\.\d+ N \(95 %\)", printed)
    ds = estimates_of("rig-identify.nc")
    for name in ("1", "2"):
        one = ds.sel(parameter=f"beta_{name}")
        force, error = ds[f"friction_force_{name}"], ds[f"friction_force_{name}_standard_error"]
        assert float(force) == pytest.approx(2000.0 * 1.5e-3 * float(one.estimate), rel=1e-12)
        assert float(error) == pytest.approx(2000.0 * 1.5e-3 * float(one.standard_error), rel=1e-12)
        assert force.attrs["units"] == error.attrs["units"] == "N"
    lines, head = without_column(LINES, HEAD, 4)
    assert main(["identify", rig(lines, text, head), "--overwrite"]) == 0
    assert "warning: no friction force in N: it needs the amplitudes of the base" in capsys.readouterr().out


def test_amplitudes_of_a_mass_under_a_force(rig, capsys):
    """X k1/P of a force P [N] and a spring k1."""
    lines = [
        f"{s},{f:.5f},{p:.5f},3.0,{x * 3.0 / 2000.0 * (2.0 * np.pi * f) ** 2:.9g}"
        for s, f, p, x in zip(SETS, FREQUENCY, LAG, RATIO, strict=True)
    ]
    head = "set,frequency_Hz,phase_lag_deg,force_N,x_m_s2"
    text = RIG.replace('excitation = "base"\ndamping_reference = "base"', 'excitation = "force"')
    assert "cannot normalise the amplitudes x_m_s2 by a force" in refusal(
        capsys, "identify", rig(lines, text, head)
    )
    text = text.replace("mu = 1.0", "mu = 1.0\nstiffness = 2000.0")
    assert main(["identify", rig(lines, text, head), "--quiet"]) == 0
    ratios = estimates_of("rig-identify.nc").data.values[len(RATIO) :]
    np.testing.assert_allclose(ratios, RATIO, rtol=1e-5)
    lines, head = without_column(lines, head, 3)
    assert "cannot normalise the amplitudes x_m_s2: " in refusal(
        capsys, "identify", rig(lines, text, head), "--overwrite"
    )


@pytest.mark.parametrize(
    ("lines", "head", "message"),
    [
        (["1,-2.0,20,1.5,1"], HEAD, "column frequency_Hz, line 2 must be > 0; got -2"),
        (["1,2.0,20,1.6,1.75"], HEAD, "cannot fit 3 unknowns to 2 data"),
        ([*LINES[:3], "1,2.5,230,1.2,1.5"], HEAD, "line 5 must be 0 to 180 deg for the "
         "loaded mass; got 230 (is it a lead, or another mass?)"),
        ([*LINES[:3], "1,2.5,20,-1.2,1.5"], HEAD, "column amplitude_ratio, line 5 must be > 0; got -1.2"),
        (LINES, HEAD.replace("frequency_Hz", "f"), "column frequency_Hz (suffixes: _Hz, _kHz, _rad_s"),
        ([columns(line, 0, 1) for line in LINES], "set,frequency_Hz", "column phase_lag_deg (suffixes"),
        (LINES, HEAD.replace("base_mm", "force_N"), "system.excitation must be force for a file with"),
    ],
)  # fmt: skip
def test_bad_tables(rig, capsys, lines, head, message):
    found = refusal(capsys, "identify", rig(lines, head=head))
    assert message in found


def test_bad_forced_files(measured, rig, capsys):
    words = {
        "phase-out-of-range": "must be 0 to 180 deg for the loaded mass",
        "negative-frequency": "line 2 must be > 0; got -2",
        "beyond-sliding": "no friction ratio gives a lag of 60 deg at r = 1.944: above resonance it is",
        "one-point": "cannot fit 3 unknowns to 2 data",
    }
    for name, message in words.items():
        path = str(measured / "bad" / f"{name}.csv")
        known = ["--set", "known.f_n=3.086"] if name == "beyond-sliding" else []
        found = refusal(capsys, "identify", rig(), "--set", f"data.file={path}", *known)
        assert message in found
        assert f"{name}.csv" in found


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sets": [1]}, "sets must be 12 labels, one per frequency; got 1"),
        ({"load": np.zeros(12)}, "load must be finite and > 0; got 0 at index 0"),
        ({"known": {"x_F": 1.0}}, "mu, contact_stiffness, delay, gain; got 'x_F'"),
        ({"sigma_phase": -1.0}, "sigma_phase must be > 0"),
        ({"system": TWO}, "phase_lag must be a mapping by mass"),
        ({"system": 3}, "system must be a frictionmap.System"),
    ],
)  # fmt: skip
def test_bad_arguments(arguments, message):
    good = {"frequency": FREQUENCY, "phase_lag": LAG, "amplitude_ratio": RATIO, "sets": SETS}
    with pytest.raises(fm.InputError) as caught:
        fm.identify.forced(**(good | arguments))
    assert message in str(caught.value)


def test_a_parameter_that_data_do_not_depend_on():
    """Where the held structure resonates friction on the second mass leaves the first one alone."""
    system = fm.System(contact_masses=[2], excitation="base", mass_ratios=[1, 1], stiffness_ratios=[1, 1])
    f, one = np.full(4, np.sqrt(2.0)), {1: np.array([1.0, 1.01, 0.99, 1.0])}
    known = {"f_n": 1.0, "zeta": 0.0, "mu": 1.0}
    with pytest.raises(fm.InputError, match="cannot identify beta: no measured quantity depends on it"):
        fm.identify.forced(f, None, one, system=system, known=known)


def test_parameters_that_data_determine_only_together():
    """Four amplitudes at one frequency: friction, frequency and damping trade without end."""
    with pytest.raises(fm.InputError, match=r"cannot identify .* separately: .*; fix one in \[known\]"):
        fm.identify.forced(np.full(4, 2.0), None, [1.61, 1.6, 1.6, 1.59], known={"mu": 1.0})


def with_spring(text):
    return text.replace('contact = "fixed-wall"', 'contact = "fixed-wall"\ncontact_stiffness = 1000.0')


def test_a_known_spring_in_the_contact(rig, capsys):
    """In [system] or in [known]: held, in the place of mu; a stiff one is nearly a rigid contact."""
    assert main(["identify", rig(), "--quiet"]) == 0
    rigid = estimates_of("rig-identify.nc")
    for text in (with_spring(RIG), RIG.replace("mu = 1.0", "contact_stiffness = 1000.0")):
        assert main(["identify", rig(text=text), "--overwrite"]) == 0
        rows = {
            line.split()[0]: line.split() for line in capsys.readouterr().out.splitlines() if line.split()
        }
        assert rows["contact_stiffness"][1:3] == ["1000", "held"]
        assert "mu" not in rows
        found = estimates_of("rig-identify.nc")
        friction = found.estimate.values[:2] / rigid.estimate.values[:2]
        assert (np.abs(friction - 1.0) < 0.1).all()  # a motion without stops differs by kt^(-1/2)
        assert (friction != 1.0).all()


@pytest.mark.slow
def test_a_spring_that_only_a_lower_bound_is_known_of(rig, capsys):
    """These data are of a rigid contact: the table shows it, and no number that cannot be used."""
    free = '\n[fit]\nfree = ["beta", "f_n", "zeta", "contact_stiffness"]\n'
    text = RIG.replace("mu = 1.0", "stiffness = 2000.0") + free
    assert main(["identify", rig(text=text), "--verbose"]) == 0
    out = capsys.readouterr().out
    row = next(line for line in out.splitlines() if line.split()[:1] == ["contact_stiffness"])
    assert "see interval" in row
    assert " to inf" in row
    assert "spring_stiffness_lower" in out
    assert "nan" not in out
    assert "warning: the data do not determine contact_stiffness: any value from" in out
    assert main(["plot", "rig-identify.nc"]) == 0
    assert main(["info", "rig-identify.nc"]) == 0
