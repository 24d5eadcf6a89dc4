"""Pictures of many motions under records: what is drawn is what the datasets hold."""

import numpy as np
import pytest
from layouts import rendered, words_of
from matplotlib.figure import Figure

import frictionmap as fm
from frictionmap import plot

RECORDS = fm.Record.generate("white", 10.0, 0.2, rms=0.5, seed=4, count=5, quantity="force")


@pytest.fixture(scope="module")
def suite():
    system = fm.System(damping_ratios=0.05, contacts=[fm.Contact("fixed-wall", 1)])
    return fm.history(system, RECORDS, beta=[0.02, 0.05, 0.1, 0.2], after=20.0, samples="none")


@pytest.fixture(scope="module")
def spectra():
    return fm.spectrum(RECORDS, [2.0, 6.0], [0.0, 0.05, 0.1, 0.2, 0.4], damping=0.05)


def _band(collection):
    """Lower and upper edge of a filled band, over increasing places."""
    points = collection.get_paths()[0].vertices
    places = np.unique(points[:, 0])
    return np.array([[f(points[points[:, 0] == at, 1]) for at in places] for f in (np.min, np.max)])


def test_peaks_over_friction_have_a_band_of_their_quartiles(suite):
    (ax,) = axes = fm.plot_history(suite)
    peaks = suite.amplitude.values[:, 0, 0, :, 0]
    assert len(ax.lines) == len(RECORDS) + 1
    np.testing.assert_array_equal(ax.lines[-1].get_ydata(), np.median(peaks, axis=0))
    np.testing.assert_allclose(_band(ax.collections[0]), np.quantile(peaks, [0.25, 0.75], axis=0), rtol=1e-14)
    rendered(axes)


def test_peaks_with_units_are_in_millimetres_over_newtons():
    units = fm.Units(natural_frequency="4 Hz", load="10 N", stiffness="2 N/mm")
    record = fm.Record.pulse("half-sine", "10 N", "0.1 s", quantity="force", unit="N")
    ds = fm.history(fm.System(damping_ratios=0.1), record, beta=["1 N", "2 N"], units=units)
    (ax,) = fm.plot_history(ds)
    assert ax.get_xlabel() == "friction force [N]"
    assert ax.get_ylabel() == "largest displacement [mm]"
    np.testing.assert_allclose(ax.lines[-1].get_xdata(), [1.0, 2.0], rtol=1e-14)
    np.testing.assert_allclose(ax.lines[-1].get_ydata(), 1e3 * ds.amplitude_m.values.ravel(), rtol=1e-14)
    axes = fm.plot_history(ds.isel(beta=[0]))
    assert axes[1].get_ylabel() == "displacement\n[mm]"
    assert axes[0].get_ylabel() == "load\n[N]"
    assert np.abs(axes[0].lines[0].get_ydata()).max() == pytest.approx(10.0, rel=1e-9)


def test_the_record_of_a_picture_has_its_unit():
    """A base acceleration of 0.3 g is drawn in m/s², without units over omega_1^2 P/k_1."""
    system = fm.System(
        damping_ratios=0.1, excitation="base", damping_reference="base", contact="joined-base-wall"
    )
    units = fm.Units(natural_frequency="4 Hz")
    record = fm.Record.pulse("half-sine", "0.3 g", "0.1 s", unit="g")
    ax, *_ = fm.plot_history(fm.history(system, record, beta=["0.1 g"], units=units))
    assert ax.get_ylabel() == "base acceleration\n[m/s²]"
    assert ax.lines[0].get_ydata().max() == pytest.approx(0.3 * 9.80665, rel=1e-9)
    ax, *_ = fm.plot_history(fm.history(system, fm.Record([0.0, 1.0, 0.0], dt=1.0), beta=[0.1]))
    assert ax.get_ylabel().startswith("base acceleration\n/ $")
    assert ax.lines[0].get_ydata().max() == 1.0


def test_energies_add_up_to_the_work_of_the_load(suite):
    (ax,) = axes = fm.plot_energies(suite)
    (line,) = ax.lines
    put_in = (suite.work_load + suite.work_walls).mean("record").values.ravel()
    np.testing.assert_allclose(line.get_ydata(), put_in, rtol=1e-12)
    friction, damping, stored = (_band(one) for one in ax.collections)
    np.testing.assert_allclose(friction[1], suite.work_friction.mean("record").values.ravel(), rtol=1e-14)
    np.testing.assert_allclose(damping[0], friction[1], rtol=1e-14)
    np.testing.assert_allclose(stored[1], put_in, rtol=1e-12)
    assert words_of(axes) == ["lost in the contacts", "lost in the damping", "stored at the end", "put in"]
    assert plot.draw(suite, "energies")[0].get_ylabel() == "energy"
    rendered(axes)


@pytest.mark.parametrize(
    ("mass", "unit", "size"), [("0.5 kg", "mJ", 1e-3), ("20 kg", "J", 1.0), ("2e6 kg", "kJ", 1e3)]
)
def test_energies_have_the_unit_that_is_handy(mass, unit, size):
    """The same shock of the base on a small, a larger and a very large mass."""
    base = {"excitation": "base", "damping_reference": "base", "contact": "joined-base-wall"}
    units = fm.Units(natural_frequency="4 Hz", mass=mass)
    record = fm.Record.pulse("half-sine", "0.3 g", "0.1 s", unit="g")
    system = fm.System(damping_ratios=0.1, **base)
    ds = fm.history(system, record, beta=["0.02 g", "0.1 g"], units=units, samples="none")
    (ax,) = fm.plot_energies(ds)
    assert ax.get_ylabel() == f"energy [{unit}]"
    put_in = (ds.work_friction_J + ds.work_damping_J + ds.energy_J).values.ravel()
    np.testing.assert_allclose(ax.lines[0].get_ydata(), put_in / size, rtol=1e-12)


@pytest.mark.parametrize("stiffness", [None, 4.0])
def test_energies_over_time_end_with_the_works(stiffness):
    """Those of the events exactly, the damping by quadrature; with a base that moves, and a belt."""
    frame = {"mass_ratios": [1, 2], "stiffness_ratios": [1, 1], "damping_ratios": 0.05}
    joint = [
        fm.Contact("joined-base-wall", 1, stiffness=stiffness),
        fm.Contact("between-masses", [1, 2], 0.5),
    ]
    shaken = fm.System(**frame, excitation="base", damping_reference="base", contacts=joint)
    belt = fm.System(**frame, contacts=[fm.Contact("fixed-wall", 2, wall_speed=0.2, stiffness=stiffness)])
    for system, share, quantity in ((shaken, 1.0, "acceleration"), (belt, 0.5, "force")):
        wrong = []
        for parts in (1, 4):  # the same straight lines
            time = np.linspace(0.0, RECORDS[0].duration, parts * (RECORDS[0].values.size - 1) + 1)
            values = share * np.interp(time, RECORDS[0].times, RECORDS[0].values)
            record = fm.Record(values, time=time, quantity=quantity)
            ds = fm.history(system, record, beta=0.2, after=5.0).squeeze()
            put_in = float(ds.work_load + ds.work_walls)
            assert np.abs(ds.lost_friction[..., -1] - ds.work_friction).max() < 1e-11 * put_in
            assert abs(ds.stored_energy[-1] - ds.energy) < 1e-11 * put_in
            assert (np.diff(ds.lost_friction) > -1e-12 * put_in).all()  # nothing comes back
            wrong.append(abs(float(ds.lost_damping[-1] - ds.work_damping)))
        assert wrong[1] < wrong[0] / 64.0  # at least the third power of the step
    (ax,) = axes = fm.plot_energies(ds)
    np.testing.assert_allclose(ax.lines[0].get_ydata()[-1], put_in, rtol=1e-3)
    assert words_of(axes) == ["lost in the contacts", "lost in the damping", "stored", "put in"]
    rendered(axes)


def test_energies_need_an_axis_of_friction(suite):
    with pytest.raises(fm.InputError, match="must have several values of beta"):
        fm.plot_energies(suite.isel(beta=[0]))
    twice = fm.history(fm.System(), RECORDS[0], beta=[0.1, 0.2], mu=[1.0, 1.2], samples="none")
    with pytest.raises(fm.InputError, match=r"one value of mu; got 2: choose one, such as --at mu=1\.0 or"):
        fm.plot_energies(twice)


def test_an_incremental_analysis_is_that_of_scaled_records(spectra):
    """Against spectra of the scaled records at the one friction."""
    (ax,) = axes = fm.plot_incremental(spectra, friction=0.1)
    for k, line in enumerate(ax.lines):
        scales = line.get_xdata()
        np.testing.assert_allclose(scales, [0.25, 0.5, 1.0, 2.0])
        scaled = fm.spectrum(RECORDS, spectra.period.values[k], 0.1, damping=0.05, scale=scales)
        peaks = scaled.amplitude.values.reshape(len(RECORDS), -1)
        np.testing.assert_allclose(line.get_ydata(), np.median(peaks, axis=0), rtol=1e-12)
        np.testing.assert_allclose(
            _band(ax.collections[k]), np.quantile(peaks, [0.25, 0.75], axis=0), rtol=1e-12
        )
    assert ax.get_xlabel() == "factor of the records, friction 0.1"
    assert fm.plot_incremental(spectra)[0].get_xlabel() == "factor of the records, friction 0.2"
    rendered(axes)


def test_an_incremental_analysis_needs_several_values_of_friction(spectra):
    with pytest.raises(fm.InputError, match="at least 2 values of beta above 0; got 1"):
        fm.plot_incremental(spectra.isel(beta=[0, 1]))
    several = fm.spectrum(RECORDS, [2.0], [0.1, 0.2], scale=[1.0, 2.0])
    for draw in (fm.plot_incremental, fm.plot_spectrum):
        with pytest.raises(fm.InputError, match=r"must have one value of scale; got 2.*--at scale=1\.0"):
            draw(several)


def test_pictures_in_given_axes_have_their_legend_below(suite, spectra):
    for draw, ds in ((fm.plot_history, suite), (fm.plot_energies, suite), (fm.plot_spectrum, spectra)):
        (new,) = draw(ds)
        given = Figure(figsize=(6.0, 6.0), layout="constrained").subplots()
        (ax,) = draw(ds, given)
        assert [one.get_text() for one in ax.get_legend().get_texts()] == words_of([new])
        assert draw(ds, Figure().subplots(), legend=False)[0].get_legend() is None
