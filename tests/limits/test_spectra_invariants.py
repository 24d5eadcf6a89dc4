"""Friction response spectra: scales, signs, order of cells, threads; statistics over records."""

import tracemalloc

import numpy as np
import pytest
import xarray as xr
from lcg_records import lcg
from scipy.stats import binom

import frictionmap as fm
from frictionmap import spectrum
from frictionmap.motions import elastic_spectra, lanes
from frictionmap.motions.record import Record
from frictionmap.motions.statistics import exceedance, lognormal, median, over_scale, quantiles

PERIODS = [0.3, 0.9, 1.0, 2.0, 5.0, np.inf]
FRICTION = [0.02, 0.1, 0.25, 0.6]


def records(count=1, scale=1.0, **options):
    return [
        Record(lcg(k + 1, 150, (1.5, -0.7), (30, 100)), dt=0.1, scale=scale, **options) for k in range(count)
    ]


def test_a_record_and_friction_times_s_are_the_motion_times_s():
    plain = spectrum(records(), PERIODS, FRICTION, mu=[1.0, 1.3], damping=0.03)
    scaled = spectrum(records(scale=3.7), PERIODS, np.array(FRICTION) * 3.7, mu=[1.0, 1.3], damping=0.03)
    for name in ("amplitude", "acceleration_amplitude", "residual", "sliding_distance"):
        size = float(abs(plain[name]).max())
        np.testing.assert_allclose(scaled[name] / 3.7, plain[name], rtol=0, atol=1e-11 * size)
    np.testing.assert_array_equal(scaled.stops, plain.stops)


def test_the_axis_of_scales_is_the_scale_of_the_record():
    whole = spectrum(records(), PERIODS, FRICTION, scale=[-2.0, 0.0, 0.5], damping=0.03)
    for k, scale in enumerate((-2.0, 0.0, 0.5)):
        if scale == 0.0:
            assert (whole.amplitude[0, k] == 0.0).all()
            assert (whole.acceleration_amplitude[0, k] == 0.0).all()
            continue
        single = spectrum(records(scale=scale), PERIODS, FRICTION, damping=0.03)
        np.testing.assert_allclose(whole.residual[0, k], single.residual[0, 0], rtol=0, atol=1e-12)
        np.testing.assert_array_equal(whole.stops[0, k], single.stops[0, 0])


def test_a_record_turned_over_turns_the_motion_over():
    plain = spectrum(records(), PERIODS, FRICTION, mu=[1.0, 1.3])
    turned = spectrum(records(scale=-1.0), PERIODS, FRICTION, mu=[1.0, 1.3])
    np.testing.assert_array_equal(turned.residual, -plain.residual)
    for name in ("amplitude", "acceleration_amplitude", "sliding_distance", "stops", "turns"):
        np.testing.assert_array_equal(turned[name], plain[name])


@pytest.mark.parametrize("interpolation", ["linear", "cubic", "hold"])
def test_a_cell_has_the_same_bits_alone_among_others_and_on_any_number_of_threads(interpolation):
    given = records(2, interpolation=interpolation)
    whole = spectrum(given, PERIODS, FRICTION, mu=[1.0, 1.5], damping=0.05, threads=1)
    assert whole.equals(spectrum(given, PERIODS, FRICTION, mu=[1.0, 1.5], damping=0.05, threads=3))
    for at in ((0, 0, 0, 0, 0), (1, 0, 1, 3, 2), (1, 0, 0, 5, 3)):
        alone = spectrum(
            given[at[0]], PERIODS[at[3]], FRICTION[at[4]], mu=whole.mu.values[at[2]], damping=0.05
        ).squeeze()
        cell = dict(zip(("record", "scale", "mu", "period", "beta"), at, strict=True))
        for name in whole.data_vars:
            np.testing.assert_array_equal(alone[name], whole[name].isel(cell), err_msg=name)


def test_friction_above_the_peak_of_the_record_holds_the_mass():
    ds = spectrum(records(), PERIODS, [1.0 - 1e-9, 1.0 + 1e-9], damping=0.03)
    assert (ds.stops[..., 0] == 1).all()
    assert (ds.stops[..., 1] == 0).all()
    assert (ds.acceleration_amplitude[..., 1] == 1.0).all()  # that of the base


def test_unequal_steps_and_equal_ones_give_the_same():
    values = lcg(3, 150, (1.5, -0.7), (30, 100))
    times = np.arange(150) * 0.1
    extra = np.sort(np.concatenate((times, [0.123, 3.31, 3.32, 9.99])))
    plain = spectrum(Record(values, dt=0.1), PERIODS, FRICTION, damping=0.02)
    more = spectrum(Record(np.interp(extra, times, values), time=extra), PERIODS, FRICTION, damping=0.02)
    np.testing.assert_array_equal(more.stops, plain.stops)
    np.testing.assert_allclose(more.amplitude, plain.amplitude, rtol=1e-10)
    np.testing.assert_allclose(more.acceleration_amplitude, plain.acceleration_amplitude, rtol=1e-10)


@pytest.mark.parametrize("interpolation", ["linear", "cubic", "hold"])
def test_blocks_of_a_record_give_the_same_bits(monkeypatch, interpolation):
    """Long records, and samples in many parts, are followed block by block."""
    given, periods = records(interpolation=interpolation), [0.02, 0.3, 2.0, np.inf]
    whole = spectrum(given, periods, FRICTION, mu=1.2, damping=0.05)
    monkeypatch.setattr(lanes, "_BLOCK", 40)
    assert spectrum(given, periods, FRICTION, mu=1.2, damping=0.05).equals(whole)


def test_a_stiff_mass_rests_where_its_spring_holds_the_load():
    """With a period far below the samples it slides with the load until this turns, and is then stuck."""
    ds = spectrum(Record([0.0, 1.0, 0.0], dt=1.0), 2 * np.pi / 500, 0.3, damping=1.0).squeeze()
    # w^2 x = -(1 - 0.3) at the peak, less the damper's part; then the load falls by 0.6 before it slides back
    slower = 2.0 / 500 + 1.0 / 500**2
    assert float(ds.amplitude) * 500**2 == pytest.approx(0.7, abs=slower)
    assert float(ds.residual) * 500**2 == pytest.approx(-0.3, abs=slower)
    with pytest.raises(fm.InputError, match="period"):
        spectrum(Record([0.0, 1.0], dt=1.0), 1e-9, 0.3)


def test_units_are_those_of_the_record():
    values = lcg(3, 150, (1.5, -0.7), (30, 100))
    g = 9.80665
    plain = spectrum(Record(values * g, dt=0.1), PERIODS, [0.1 * g, 0.2 * g])
    ds = spectrum(Record(values, dt=0.1, unit="g"), PERIODS, ["0.1 g", "0.2 g"])
    np.testing.assert_allclose(ds.amplitude, plain.amplitude, rtol=1e-10)
    assert ds.amplitude.attrs["units"] == "m"
    assert ds.acceleration_amplitude.attrs["units"] == "m s-2"
    np.testing.assert_allclose(ds.beta, [0.980665, 1.96133])


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"period": [0.0, 1.0]}, "period"),
        ({"period": [2.0, 1.0]}, "period"),
        ({"friction": [-0.1]}, "friction"),
        ({"friction": ["0.1 g"]}, "friction"),
        ({"mu": 0.9}, "mu"),
        ({"damping": -0.1}, "damping"),
        ({"records": []}, "records"),
        ({"records": [1.0]}, r"records\[0\]"),
    ],
)
def test_refusals_name_the_argument(change, name):
    given = {"records": records(), "period": [1.0], "friction": [0.1]} | change
    with pytest.raises(fm.InputError, match=name):
        spectrum(given.pop("records"), given.pop("period"), given.pop("friction"), **given)


def drawn(count, cells, seed=1):
    values = np.random.default_rng(seed).lognormal(1.0, 0.5, (count, cells))
    return xr.DataArray(values, dims=("record", "cell"), attrs={"long_name": "peak", "units": "m"})


@pytest.mark.parametrize(("count", "share"), [(11, 0.5), (40, 0.5), (40, 0.84), (200, 0.16)])
def test_intervals_of_quantiles_contain_them_as_often_as_promised(count, share):
    """And no narrower ones do: one order statistic less at an end breaks the promise of that end."""
    values = drawn(count, 4000)
    found = quantiles(values, [share]).isel(quantile=0)
    exact = np.exp(1.0 + 0.5 * {0.5: 0.0, 0.84: 0.994457883209753, 0.16: -0.994457883209753}[share])
    above, below = float((found.low > exact).mean()), float((found.high < exact).mean())
    assert above <= 0.025 + 3 * np.sqrt(0.025 / 4000)
    assert below <= 0.025 + 3 * np.sqrt(0.025 / 4000)
    ordered = np.sort(values.values, axis=0)
    low = int(np.flatnonzero(ordered[:, 0] == float(found.low[0]))[0])
    assert binom.cdf(low, count, share) <= 0.025 < binom.cdf(low + 1, count, share)


def test_few_records_give_no_interval():
    found = quantiles(drawn(3, 2), [0.5])
    assert (found.low == -np.inf).all()
    assert (found.high == np.inf).all()


def test_median_and_lognormal_fit():
    values = drawn(20000, 1)
    found, fit = median(values), lognormal(values)
    assert float(found.low[0]) < float(found.estimate[0]) == float(np.median(values)) < float(found.high[0])
    assert float(fit["median"][0]) == pytest.approx(np.e, abs=4 * float(fit.median_error[0]))
    assert float(fit.dispersion[0]) == pytest.approx(0.5, abs=4 * float(fit.dispersion_error[0]))
    assert float(fit.median_error[0]) == pytest.approx(np.e * 0.5 / np.sqrt(20000), rel=0.05)
    with pytest.raises(fm.InputError, match="records"):
        lognormal(drawn(1, 1))


def test_an_incremental_analysis_is_read_from_a_spectrum():
    friction = 0.1
    scales = np.array([0.2, 0.5, 1.0, 2.5])
    ds = spectrum(records(5), [0.8, 2.0], np.sort(friction / scales), mu=1.2, damping=0.05)
    direct = spectrum(records(5), [0.8, 2.0], friction, mu=1.2, damping=0.05, scale=scales)
    for name in ("amplitude", "acceleration_amplitude", "residual", "stops"):
        read = over_scale(ds, friction, name).transpose("record", "scale", "mu", "period")
        np.testing.assert_allclose(read.scale, scales, rtol=1e-15)
        np.testing.assert_allclose(read, direct[name].isel(beta=0), rtol=1e-9, atol=1e-12)


def test_exceedance_counts_records():
    values = xr.DataArray([[1.0, 5.0], [2.0, 6.0], [3.0, 7.0]], dims=("record", "scale"))
    found = exceedance(values, 2.5)
    np.testing.assert_allclose(found.share, [1 / 3, 1.0])
    # all of three: p^3 = 0.025
    assert float(found.low[1]) == pytest.approx(0.025 ** (1 / 3), rel=1e-9)
    assert float(found.high[1]) == 1.0
    # one of three: P(at least 1) = 0.025 at the lower end, P(at most 1) = 0.025 at the upper one
    assert 1 - binom.cdf(0, 3, float(found.low[0])) == pytest.approx(0.025, rel=1e-9)
    assert binom.cdf(1, 3, float(found.high[0])) == pytest.approx(0.025, rel=1e-9)


def peak_memory(records, **more):
    tracemalloc.start()
    try:
        spectrum(records, [0.2, 1.0], [0.1, 0.2], threads=2, **more)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("samples", "more"), [(4000, {}), (300, {"contact_stiffness": 5.0})], ids=["rigid", "spring"]
)
def test_memory_does_not_grow_with_the_records(samples, more, monkeypatch):
    """They are prepared one by one, or in groups of four with a contact spring, and each of the two threads
    holds one: eight records are as much as there is at a time. All twenty at once take 2.8 times as much."""
    monkeypatch.setattr(elastic_spectra, "_TOGETHER", 4 * samples)
    records = fm.Record.generate("white", 0.05 * samples, 0.05, rms=1.0, count=20)
    peak_memory(records[:1], **more)  # what is loaded and compiled at first
    assert peak_memory(records, **more) < 1.6 * peak_memory(records[:8], **more)
