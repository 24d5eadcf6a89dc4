"""
Published results, checked
==========================

What other authors have published about one mass with dry friction, computed again. The formulas of the papers
are written out below, independently of frictionmap. The comparison with the thesis is in the other figures;
the bibliography of this manual has the full references.
"""

import matplotlib.pyplot as plt
import numpy as np

import frictionmap as fm

# %%
# Den Hartog (1930, 1931) and Hundal (1979): motion without stops
# ---------------------------------------------------------------
# Den Hartog found the amplitude of a motion without stops in closed form, without and with viscous damping.
# Hundal extended it to a mass whose spring and dashpot are attached to a shaken base. With b = 1/r, the
# damping ratio zeta, and V the amplitude without friction, the amplitude is
# sqrt(V^2 - beta^2 h^2) - beta g.


def amplitude(r, beta, zeta, base=False):
    """The amplitude of a motion without stops, over P/k or over Y."""
    b, root = 1.0 / r, np.sqrt(1.0 - zeta**2)
    below = np.cosh(zeta * b * np.pi) + np.cos(root * b * np.pi)
    g = (np.sinh(zeta * b * np.pi) - zeta / root * np.sin(root * b * np.pi)) / below
    h = b / root * np.sin(root * b * np.pi) / below
    load = np.hypot(1.0, 2.0 * zeta * r) if base else 1.0
    free = load / np.hypot(1.0 - r**2, 2.0 * zeta * r)
    return np.sqrt(free**2 - (beta * h) ** 2) - beta * g


r, friction = np.linspace(0.1525, 2.5025, 471), [0.1, 0.3, 0.5, 0.7]
systems = {
    "Den Hartog, no dashpot": (0.0, False),
    "Den Hartog, dashpot to the wall": (0.1, False),
    "Hundal, dashpot to the base": (0.1, True),
}
fig, axes = plt.subplots(1, 3, figsize=(10.0, 3.4), sharey=True, layout="constrained")
amplitude_errors = {}
for ax, (name, (zeta, base)) in zip(axes, systems.items(), strict=True):
    where = {"excitation": "base", "damping_reference": "base"} if base else {}
    ds = fm.sweep(
        fm.System(damping_ratios=zeta, **where), r, friction, outputs=["regime", "contact_amplitude"]
    )
    errors = []
    for beta in friction:
        row = ds.sel(beta=beta).isel(mu=0)
        slides = (row.regime == fm.regimes.CONTINUOUS).values
        published = np.where(slides, amplitude(np.where(slides, r, np.nan), beta, zeta, base), np.nan)
        ax.plot(r, row.contact_amplitude, color="0.8", linewidth=4)
        ax.plot(r, published, color="k", linewidth=1)
        errors.append(np.abs(row.contact_amplitude.values[slides] / published[slides] - 1.0))
    amplitude_errors[name] = np.concatenate(errors)
    ax.set(title=name, xlabel="frequency ratio r", ylim=(0.0, 5.0))
axes[0].set_ylabel("amplitude")
axes[0].plot([], [], color="0.8", linewidth=4, label="frictionmap, all regimes")
axes[0].plot([], [], color="k", linewidth=1, label="published, without stops")
axes[0].legend(loc="upper right", fontsize="small")
for name, errors in amplitude_errors.items():
    print(f"{name}: {errors.size} amplitudes, relative difference at most {errors.max():.1e}")

# %%
# Friction alone limits the resonance only for beta >= pi/4 (Den Hartog). At high frequency the mass slides
# without stops below beta = 2/sqrt(4 mu^2 + pi^2) (for mu = 1: Csernak and Stepan 2006).
at_resonance = fm.boundaries(fm.System(), [1.0]).beta_lim.item()
print(f"beta_lim at r = 1: {at_resonance:.15f}; pi/4 = {np.pi / 4:.15f}")
for mu in (1.0, 1.5):
    limit = fm.boundaries(fm.System(), [1e4], mu=mu).beta_lim.item()
    print(f"mu = {mu}: beta_lim at r = 10,000: {limit:.9f}; limit {2 / np.hypot(2 * mu, np.pi):.9f}")

# %%
# Shaw (1986): stability
# ----------------------
# Shaw derived the Floquet multipliers of motions without stops. A disturbance obeys the equation of free
# vibration. At each turn its velocity changes by the ratio of the accelerations after and before the turn.
# A modulus below 1 means that the disturbance dies out. It is 1 where the friction goes to zero without
# damping, or where a turn is passed with no jump in acceleration.


def largest_multiplier(r, beta, zeta):
    """The largest modulus over one period of excitation."""
    root, half = np.sqrt(1.0 - zeta**2), np.pi / r
    c, s = np.cos(root * half), np.sin(root * half) / root
    free = np.exp(-zeta * half) * np.array([[c + zeta * s, s], [-s, c - zeta * s]])
    # response to a square wave of friction, and of the load, at a maximum of x
    x, v = np.linalg.solve(free + np.eye(2), (free - np.eye(2)) @ [1.0, 0.0])
    response = 1.0 / (1.0 - r**2 + 2j * zeta * r)
    imaginary = beta * v / r
    top = np.sqrt(abs(response) ** 2 - imaginary**2) + 1j * imaginary
    load = (top / response).real
    place = top.real + beta * x
    turn = np.diag([1.0, (load - place + beta) / (load - place - beta)])
    return np.abs(np.linalg.eigvals(turn @ free)).max() ** 2


fig, axes = plt.subplots(1, 2, figsize=(8.0, 3.4), sharey=True, layout="constrained")
multiplier_errors = []
for ax, zeta in zip(axes, (0.0, 0.05), strict=True):
    ds = fm.sweep(fm.System(damping_ratios=zeta), r, [0.1, 0.3], outputs=["regime", "multiplier", "status"])
    for beta, style in ((0.1, "-"), (0.3, "--")):
        row = ds.sel(beta=beta).isel(mu=0)
        known = ((row.regime == fm.regimes.CONTINUOUS) & np.isfinite(row.multiplier)).values
        shaw = np.array([largest_multiplier(one, beta, zeta) for one in r[known]])
        multiplier_errors.append(np.abs(row.multiplier.values[known] - shaw))
        ax.plot(r, np.where(known, row.multiplier, np.nan), style, color="0.7", linewidth=4)
        ax.plot(r[known], shaw, ".", markersize=2, label=f"beta = {beta}")
    ax.set(title=f"damping ratio {zeta}", xlabel="frequency ratio r")
    ax.legend(fontsize="small")
axes[0].set_ylabel("largest multiplier")
multiplier_errors = np.concatenate(multiplier_errors)
print(f"{multiplier_errors.size} multipliers, difference at most {multiplier_errors.max():.1e}")

# %%
# Hong and Liu (2000), Begley and Virgin (1997): many stops at low frequency
# --------------------------------------------------------------------------
# Hong and Liu divided the plane of the ratios of frequencies and of forces into steady motions with 0, 1, 2,
# 4, 6, 8, 10, 12 and 14 stops per cycle. Begley and Virgin studied the same motions at low frequency, also in
# an experiment. Their figures are not reproduced here. All even numbers of the list occur, and higher ones at
# lower frequencies; a single stop per cycle does not occur on this grid.
low = fm.sweep(fm.System(), np.linspace(0.02, 0.6, 400), np.linspace(0.002, 0.5, 300))
counted = low.stops_per_cycle.where(low.status == fm.regimes.RESOLVED)
numbers, cells = np.unique(counted.values[np.isfinite(counted.values)], return_counts=True)
print("stops per cycle and cells:", {int(n): int(k) for n, k in zip(numbers, cells, strict=True)})
fm.plot_regimes(low)

# %%
# Csernak, Stepan and Shaw (2007): asymmetric motions at r = 1/(2n)
# -----------------------------------------------------------------
# At these frequencies, without damping, a free vibration A cos(2n tau) has zero velocity at both turns of the
# symmetric motion V cos(tau) + beta (1 - cos(2n tau)). The sum is a motion without stops, too, as long as its
# velocity does not change sign between the turns: for beta + abs(A) < beta_lim. A depends on the initial
# state. frictionmap marks such cells as `marginal` and gives the amplitude of the symmetric motion.


def asymmetric(tau, n, beta, free):
    """Displacement and velocity with a free vibration of this amplitude; tau from 0 to 2 pi."""
    linear = 1.0 / (1.0 - 1.0 / (2 * n) ** 2)
    falling = tau < np.pi
    sense, s = np.where(falling, 1.0, -1.0), np.where(falling, tau, tau - np.pi)
    x = sense * (linear * np.cos(s) + beta * (1.0 - np.cos(2 * n * s))) + free * np.cos(2 * n * s)
    v = sense * (-linear * np.sin(s) + 2 * n * beta * np.sin(2 * n * s)) - 2 * n * free * np.sin(2 * n * s)
    return x, v, sense


def slides_without_stops(n, beta, free):
    """Whether the velocity has one sign between the turns."""
    tau = np.linspace(0.0, 2.0 * np.pi, 4001)[1:-1]
    inner = np.abs(tau - np.pi) > 1e-9
    _, v, sense = asymmetric(tau[inner], n, beta, free)
    return bool((v * sense < 0.0).all())


fig, ax = plt.subplots(figsize=(6.0, 3.6), layout="constrained")
beta, tau = 0.2, np.linspace(0.0, 2.0 * np.pi, 801)
for free in (-0.12, 0.0, 0.12):
    ax.plot(tau / np.pi, asymmetric(tau, 1, beta, free)[0], label=f"A = {free}")
ax.set(xlabel="phase of the load / pi", ylabel="displacement / (P/k)", title=f"r = 1/2, beta = {beta}")
ax.legend()
asymmetric_limits = {}
for n in (1, 2, 3):
    system, r = fm.System(), 1.0 / (2 * n)
    beta_lim = fm.boundaries(system, [r]).beta_lim.item()
    beta = 0.6 * beta_lim
    inside, outside = (slides_without_stops(n, beta, side * (beta_lim - beta)) for side in (0.999, 1.001))
    status = fm.sweep(system, [r], [beta], outputs=["status"]).status.item()
    asymmetric_limits[n] = (inside, outside, status == fm.regimes.MARGINAL)
    print(f"r = 1/{2 * n}: without stops just inside {inside}, just outside {outside}; status {status}")

# %%
# Griffin (1980): friction with a spring
# --------------------------------------
# The performance curve of a blade damper, peak response over friction, is computed in the worked examples of
# dampers. Griffin's analysis with the first harmonic gives a least peak of pi/kt without damping; the exact
# one differs by a few per cent.
damper = fm.System(damping_ratios=0.001, contact_stiffness=1.0)
r = np.linspace(1.0, 1.5, 401)
peaks = fm.sweep(damper, r, np.linspace(1.3, 1.7, 41), outputs=["contact_amplitude"]).contact_amplitude.max(
    "r"
)
print(f"least peak for kt = 1, almost no damping: {peaks.min().item():.3f}; pi/kt = {np.pi:.3f}")
