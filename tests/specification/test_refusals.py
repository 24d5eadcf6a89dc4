"""Every kind of refusal as (call, message): the contract of the program with those who make a mistake.

A call is a command (after `frictionmap`), a Python expression, or a query of the page (?key=value).  Its
message is the indented line below it, where three dots stand for any text.  `folder` makes the files and
`_names` the names in expressions.  All messages have one of the forms `FORMS`.
"""

import ast
import contextlib
import io
import pickle
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import frictionmap as fm
from frictionmap.command_line.cli import main
from frictionmap.datasets.variables import coordinate, label_variable
from frictionmap.explorer.queries import read_query
from frictionmap.explorer.scene import scene_of_system

ROOT = Path(__file__).parents[2]

#: What a message looks like; a key, a file or a table may stand before it.
FORMS = (
    r"(.+: )?unknown .+; valid: .+",
    r"(.+: )?cannot .+: .+; .+",
    r".+ must .+; got .+",
)

#: Templates that pass another message on, with the place it is about: {} is what is filled in.
PASSED_ON = (r"(.*: )?\{\}", r"\{\}.*", r"law_file: \{\} in \{\}")

TABLE = r"""
# Configurations and --set
map none.toml
    cannot read configuration none.toml: No such file or directory; give the path of a TOML file
map empty.toml
    the configuration must have a table [system]; got none
map typo.toml
    configuration typo.toml: cannot parse as TOML: ...; correct the syntax
map latin.toml
    cannot read configuration latin.toml: it is not text in UTF-8; save it as UTF-8
map rig.toml
    cannot compute from a configuration with [data]: it describes measured data; use frictionmap identify
map pulse.toml
    cannot compute steady states from a configuration without [grid]: it describes motions in time; use frictionmap history
curves spectra.toml
    cannot compute steady states from a configuration without [grid]: it describes motions in time; use frictionmap spectrum
history pulse.toml --set history.friction=-1
    history.friction must be >= 0; got -1
history pulse.toml --set history.friction=[0.1,-1]
    history.friction[1] must be >= 0; got -1
history pulse.toml --set history.friction=[]
    history.friction must be a number or a list of numbers; got []
history pulse.toml --set history.beta=0.1
    cannot use history.friction with history.beta: both are the friction; omit one
map good.toml --set 'system.law={speed=[0.0,1.0],factor=[1.0,0.8]}'
    unknown key 'system.law' (it is a key of an entry of [[system.contacts]]); valid: ...
map good.toml --set titel=x
    unknown key 'titel' (did you mean title?); valid: title, system, grid, solver, curves, design, record, history, spectrum, units, axes
map good.toml --set title=1
    title must be text; got 1
map good.toml --set system.contct=fixed-wall
    unknown key 'system.contct' (did you mean contact?); valid: contact, contact_masses, load_mass, load, mass_ratios, stiffness_ratios, masses, springs, dampers, damping_ratios, matrices, sectors, reduce, rayleigh, decouple, frequency_scale, stiffness_scale, excitation, damping_reference, base_control, modes, beam, plate, load_harmonics, load_file, waveform, harmonics, load_offset, contact_stiffness, wall_velocity, wall_speed, normal_load, contacts
map good.toml --set solver.step=9
    unknown key 'solver.step' (did you mean steps?); valid: start, cycles, tolerance, steps, skip, steady, outputs
map good.toml --set grid.r.stepp=1
    cannot apply --set grid.r.stepp=1: grid.r is not a table; set grid.r itself, now 1.0
map good.toml --set grid=1
    grid must be a table [grid]; got 1
map good.toml --set grid.r
    --set must be KEY=VALUE, such as grid.r.step=0.01; got 'grid.r'
map good.toml --set grid.beta.num=3 --set grid.beta.step=0.5
    cannot apply --set grid.beta.step=0.5: it undoes --set grid.beta.num=3; give one of the two
map good.toml --set grid.r=-1
    grid.r must be >= 0; got -1.0 at index 0
map good.toml --set grid.r=text
    grid.r must be a number, a list of numbers or a table; got 'text'
map good.toml --set grid.r=[]
    grid.r must have at least one value; got none
map good.toml --set grid.r=[1,0.5]
    grid.r must be increasing; got 0.5 at index 1
map good.toml --set grid.r=[1,nan]
    grid.r[1] must be finite; got nan
map good.toml --set grid.r={start=0}
    grid.r must be { start, stop, step }, { start, stop, num } or { values }; got start
map good.toml --set grid.r={start=1,stop=0,step=0.1}
    grid.r.stop must be >= start (1); got 0
map good.toml --set grid.r={start=0,stop=1,step=0}
    grid.r.step must be > 0; got 0
map good.toml --set grid.r={start=0,stop=1,num=1}
    grid.r.num must be >= 2 to hold both 0 and 1; got 1
map good.toml --set grid.r={start=0,stop=1,step=1e-12}
    grid.r.step must leave at most 1e+09 values; got 1e-12, which makes 1e+12
map good.toml --set grid.mu=0.9
    grid.mu must be >= 1; got 0.9 at index 0
map good.toml --set grid.r={start=0,stop=1,num=100000} --set grid.beta={start=0,stop=1,num=100000}
    grid must have at most 1e+09 cells in memory; got 1e+10 (1 mu x 100000 r x 100000 beta)
map good.toml --set grid.r=2.1Hz
    cannot convert grid.r = '2.1Hz' to ratios: a reference value is missing; give units.natural_frequency (or units.mass with units.stiffness), such as units.natural_frequency = "4.2 Hz"
map good.toml --set 'grid.r="2,1 Hz"' --set 'units.natural_frequency="4.2 Hz"'
    grid.r must be a number with a unit of frequency (Hz, kHz, rad/s, rpm), such as '4.2 Hz'; got '2,1 Hz': use a decimal point, not a comma
map good.toml --set 'grid.r="2.1 N"' --set 'units.natural_frequency="4.2 Hz"'
    grid.r must be a number with a unit of frequency (Hz, kHz, rad/s, rpm), such as '4.2 Hz'; got '2.1 N': N is a unit of force
map good.toml --set units.lod=1
    unknown key 'units.lod' (did you mean load?); valid: natural_frequency, load, base_amplitude, base_acceleration, acceleration_frequency, stiffness, mass, normal_force
map good.toml --set 'units.load="1"'
    units.load must be a number with a unit of force (N, mN, kN, lbf), such as '12.5 N'; got '1': it has no unit
map good.toml --set 'units.load="-1 N"'
    units.load must be > 0; got '-1 N'
map good.toml --set 'units={load="1 N",base_amplitude="1 mm"}'
    cannot use units.base_amplitude with load: one follows from the other; give one of them
map good.toml --set 'units={mass="1 kg"}'
    cannot use units.mass alone: it gives k1 = m1 omega_1^2 with natural_frequency, and this frequency with stiffness; give one of the two
map good.toml --set 'units={base_acceleration="0.5 g"}'
    cannot use units.base_acceleration without acceleration_frequency: Y = a/omega^2 needs its frequency, or natural_frequency where a is the same at all frequencies; give both
map good.toml --set 'units.base_amplitude="1 mm"'
    cannot use units.base_amplitude: it needs base excitation; for a force-excited system use units.load
map good.toml --set 'units.stiffness=model'
    units.stiffness must be a number with its unit for a chain, whose numbers are ratios; got 'model'
map good.toml --set solver.cycles=0
    solver.cycles must be >= 1; got 0
map good.toml --set solver.tolerance=1
    solver.tolerance must be <= 0.001; got 1
map good.toml --set solver.start=sliding
    solver.start must be one of rest, moving; got 'sliding'
map good.toml --set solver.skip=all
    solver.skip must be one of exact, none; got 'all'
map good.toml --set solver.outputs=[]
    solver.outputs must name at least one of (regime: regime, contact_regime, stops_per_cycle, turns_per_cycle, stuck_fraction, slips_per_cycle, slip_reversals_per_cycle, elastic_fraction, open_fraction, separations_per_cycle, segment_crossings, segment_fraction, spring_crossings, also_reachable, sliding_limit, beta_lim_modal; motion: contact_amplitude, amplitude, contact_peak_to_peak, contact_midpoint, peak_to_peak, midpoint, contact_first_harmonic_amplitude, contact_first_harmonic_phase, drift, acceleration_amplitude, mean_velocity, period, asymmetry, least_slip; forces and energy: sliding_distance, work_friction, work_input, work_damping, work_wall, equivalent_damping, base_force, normal_force_min, normal_force_max, spring_force_max; diagnostics: origin, cycles, status, multiplier, stops_per_cycle_error, stuck_fraction_error, lyapunov_exponent, lyapunov_exponent_error, release_order, unique); got none
map good.toml --set 'solver.outputs=["regim"]'
    solver.outputs must be some of (regime: regime, stops_per_cycle, stuck_fraction, also_reachable, sliding_limit, beta_lim_modal; motion: contact_amplitude, amplitude, contact_first_harmonic_amplitude, contact_first_harmonic_phase, drift, acceleration_amplitude, period, asymmetry; forces and energy: sliding_distance, work_friction, work_input, work_damping, equivalent_damping, base_force; diagnostics: origin, cycles, status, multiplier, stops_per_cycle_error, stuck_fraction_error, lyapunov_exponent, lyapunov_exponent_error); got 'regim' (did you mean regime?)
map good.toml --set 'axes.damping_ratio=[0,0.1]'
    axes must name a number of the system, i counted from 1: damping_ratios, load_mass, frequency_scale, stiffness_scale, contact_stiffness, wall_velocity, wall_speed, mass_ratios[i], stiffness_ratios[i], damping_ratios[i], dampers[i], load[i], contact_masses[i], contacts[i].force, contacts[i].ratio, contacts[i].mu, contacts[i].stiffness, contacts[i].wall_velocity, contacts[i].wall_speed, contacts[i].normal.preload, contacts[i].normal.stiffness, contacts[i].normal.friction; got 'damping_ratio' (did you mean damping_ratios?)
map good.toml --set 'axes={"mass_ratios[2]"=[1,2]}'
    axes, at mass_ratios_2 = 1: cannot use axis mass_ratios[2]: the system has 1 mass; use an index <= 1
map good.toml --set 'axes={damping_ratios=[]}'
    axes.damping_ratios must have at least one value; got none
map good.toml --set 'axes={sample={file="none.csv"}}'
    cannot read axes.sample.file, none.csv: No such file or directory; give a CSV file with names in its first row
curves good.toml --set curves.harmonics=-1
    curves.harmonics must be >= 0; got -1
curves good.toml --set 'curves.quantities=["phase_lag"]'
    curves.quantities must be one of amplitude, phase, first_harmonic, energy, harmonics, transmitted_force, distortion, drift, acceleration_amplitude, base_force; got 'phase_lag' (did you mean phase?)
curves good.toml --set 'axes={damping_ratios=[0,0.1]}'
    cannot run curves with [axes]: [axes] is supported by `map` only; remove it

# Systems in configurations
map good.toml --set system.contact=wall
    system.contact must be one of fixed-wall, joined-base-wall, between-masses; got 'wall' (did you mean fixed-wall?)
map good.toml --set system.contact=between-masses
    system.contact must be fixed-wall or joined-base-wall for one mass; got 'between-masses'
map good.toml --set system.contact_masses=[2]
    system.contact_masses[0] must be <= 1; got 2
map good.toml --set system.contact_masses=[1,2]
    system.contact_masses must name one mass for fixed-wall; got [1, 2]
map good.toml --set system.contact_masses=1
    system.contact_masses must be a list of whole numbers; got 1
map good.toml --set system.load_mass=2
    system.load_mass must be <= 1; got 2
map good.toml --set system.load=[1] --set system.load_mass=1
    cannot use system.load with load_mass: both define the load; omit one of them
map good.toml --set system.load=[0]
    system.load must have a value that is not zero; got none
map good.toml --set system.load=[1,1]
    system.load must have one number per mass (1); got 2
map good.toml --set system.load=[[1]]
    system.load[0] must be a number or [real part, imaginary part]; got [1]
map good.toml --set system.mass_ratios=[2]
    system.mass_ratios[0] must be 1, the unit of the others; got 2
map good.toml --set system.mass_ratios=[]
    system.mass_ratios must have at least one value; got none
map good.toml --set system.mass_ratios=[1,-1]
    system.mass_ratios[1] must be > 0; got -1
map good.toml --set system.mass_ratios=[1,1]
    system.stiffness_ratios must have as many values as mass_ratios (2); got 1
map good.toml --set system.damping_ratios=-0.1
    system.damping_ratios must be >= 0; got -0.1
map good.toml --set system.damping_ratios=101
    system.damping_ratios must be <= 100; got 101
map good.toml --set system.damping_ratios=[0.1,0.2]
    system.damping_ratios must be one number, or one per mode (1); got 2
map good.toml --set system.damping_ratios=true
    system.damping_ratios must be a number; got True
map good.toml --set system.excitation=ground
    system.excitation must be one of force, base; got 'ground'
map good.toml --set system.damping_reference=base
    system.damping_reference must be ground for a force-excited structure; got 'base'
map good.toml --set system.contact=joined-base-wall --set system.excitation=force
    system.excitation must be base for a joined-base-wall, whose base loads the structure; got 'force'
map good.toml --set system.rayleigh=[0,0.1]
    cannot use system.rayleigh without matrices: a chain needs no such key; omit it
map good.toml --set system.frequency_scale=2
    cannot use system.frequency_scale = 2 without matrices: its units are those of the first mass and spring; omit it
map good.toml --set system.stiffness_scale=2
    cannot use system.stiffness_scale = 2 without matrices: its units are those of the first mass and spring; omit it
map good.toml --set system.decouple=0.1
    cannot use system.decouple without matrices: a chain needs no such key; omit it
map good.toml --set system.matrices=none.npz
    system.matrices must be an .npz file with arrays M, K and optionally C; got none.npz: No such file or directory
map good.toml --set system.matrices=frame.mtx
    system.matrices must be given one by one for .mtx files, such as { M = "m.mtx", K = "k.mtx" }; got frame.mtx
map good.toml --set system.matrices=5
    system.matrices must be the path of an .npz file, or a table of arrays M, K and optionally C; got 5
map good.toml --set 'system.matrices={M="frame.mtx"}'
    system.matrices must have arrays M, K and optionally C; got M
map good.toml --set 'system.matrices={M="bad.mtx",K="frame.mtx"}'
    system.matrices: cannot read bad.mtx, line 1: expected %%MatrixMarket matrix coordinate|array real general|symmetric; got '%%MatrixMarket matrix coordinate complex general'
map good.toml --set 'system.matrices={M="short.mtx",K="frame.mtx"}'
    system.matrices: cannot read short.mtx: its header announces 3 entries; got 1
map good.toml --set 'system.matrices={M="frame.mtx",K=[[1]]}'
    system.matrices must all be files, such as { M = "m.mtx", K = "k.mtx" }, or arrays; got a file of M
map good.toml --set system.matrices={M=[[1]]}
    system.matrices must have arrays M, K and optionally C; got M
map good.toml --set system.matrices={M=[[1]],K=[[1]],D=[[1]]}
    system.matrices: unknown array 'D'; valid: M, K, C, dofs
map good.toml --set system.matrices={M=[[1]],K=[[1,0],[0,1]]}
    system.matrices: K must have the shape of M, (1, 1); got (2, 2)
map good.toml --set system.matrices={M=[[1,2]],K=[[1]]}
    system.matrices: M must be square, (n, n); got shape (1, 2)
map good.toml --set system.matrices={M=[[1,0],[0,0]],K=[[2,-1],[-1,1]]}
    system.matrices: M must be positive definite; got a singular matrix, with eigenvalues from 0 to 1: degree of freedom 2 has no mass; eliminate it with reduce
map good.toml --set system.matrices={M=[[1,0],[0,1]],K=[[-2,0],[0,1]]}
    system.matrices: K must be positive semi-definite; got an indefinite matrix, with eigenvalues from -2 to 1
map good.toml --set system.matrices={M=[[1,0],[0,1]],K=[[2,-1],[1,1]]}
    system.matrices: K must be symmetric; got -1.0 at [0, 1] and 1.0 at [1, 0]
map good.toml --set system.matrices={M=[[1]],K=[[1]]} --set system.mass_ratios=[1]
    cannot use system.mass_ratios = [1] with matrices: both define the structure; omit one
map good.toml --set system.matrices={M=[[1]],K=[[1]],C=[[0.1]]} --set system.damping_ratios=0.1
    cannot use system.damping_ratios with matrices: C defines the damping; omit one
map good.toml --set system.matrices={M=[[1]],K=[[1]]} --set system.rayleigh=[1]
    system.rayleigh must be two numbers [a, b], C = a M + b K; got [1]
map good.toml --set system.matrices={M=[[1]],K=[[1]]} --set system.rayleigh=[0,0.1] --set system.damping_ratios=0.1
    cannot use system.damping_ratios with rayleigh: both define the damping; omit one
map good.toml --set system.matrices={M=[[1]],K=[[1]]} --set 'units={natural_frequency="1 Hz",mass="1 kg"}'
    cannot use units.mass with matrices: only a chain has a first mass; use units.stiffness for stiffness_scale
map good.toml --set system.matrices={M=[[1,0],[0,1]],K=[[2,-1],[-1,1]]} --set system.reduce={mods=1}
    system.reduce must be { keep = [...], modes = 16 }; got {'mods': 1}
map good.toml --set system.matrices={M=[[1,0],[0,1]],K=[[2,-1],[-1,1]]} --set system.reduce={modes=1,mods=1}
    [system]: unknown key of reduce 'mods'; valid: keep, modes, allow
map good.toml --set system.matrices={M=[[1,0],[0,1]],K=[[2,-1],[-1,1]]} --set system.reduce={modes=2}
    system.reduce.modes must be at most 1, as many as there are; got 2
map good.toml --set system.matrices={M=[[1,0],[0,1]],K=[[2,-1],[-1,1]]} --set system.reduce={modes=0}
    system.reduce: cannot keep the error below 0.001 in the range of r with 0 modes: natural frequencies within 1.4e-01 of the whole structure's, compliances within 0.0e+00; 1 mode suffices

# Commands, outputs and files
map
    frictionmap map: the following arguments are required: CONFIG.toml (see frictionmap map --help)
map good.toml -o -
    frictionmap map: argument -o: must be the name of a file; got '-' (see frictionmap map --help)
map good.toml --threads 0
    frictionmap map: argument --threads: must be >= 1; got 0 (see frictionmap map --help)
map good.toml --threads two
    frictionmap map: argument --threads: invalid whole number value: 'two' (see frictionmap map --help)
map good.toml -o a.nc -o b.nc
    frictionmap map: argument -o: must be given once (see frictionmap map --help)
map good.toml -o none/a.nc
    -o must be in an existing folder; got none/a.nc
map good.toml -o folder
    -o must be a file; got the folder folder
map good.toml -o old.nc
    cannot write old.nc: it already exists; use --overwrite or another -o
map good.toml -o good.toml --overwrite
    cannot write good.toml: it is the input file good.toml; use another -o
map good.toml --workers 2
    cannot use --workers or --scheduler: they compute stores only; give -o OUT.zarr
map good.toml -o a.zarr --workers 2 --threads 2
    cannot use --threads with workers: every worker has one thread; omit --threads
map good.toml -o a.zarr --workers 2 --scheduler tcp://a:1
    frictionmap map: argument --scheduler: not allowed with argument --workers (see frictionmap map --help)
map good.toml -o old.zarr
    -o must be a store, which is a folder; got the file old.zarr
map good.toml -o folder.zarr --overwrite
    cannot overwrite folder.zarr: the folder is not a store; use another -o
curves good.toml -o a.zarr
    cannot write a.zarr: only `map` and `spectrum` can write a .zarr store; use another -o
response good.toml --r 1
    --beta must be given, such as --beta 0.5; got nothing
response good.toml --r 0 --beta 1
    r must be > 0: at r = 0 there is no motion in time; got 0
response good.toml --r x --beta 1
    frictionmap response: argument --r: invalid float value: 'x' (see frictionmap response --help)
response good.toml --r 1 --beta -1
    beta must be >= 0; got -1.0
response good.toml --r 1 --beta 1 --mu 0.5
    mu must be >= 1; got 0.5
response good.toml --r 1 --beta 1 --set grid.mu=[1,1.5]
    cannot choose mu: grid.mu has 2 values, 1, 1.5; give --mu
init a.txt
    NAME.toml must end in .toml; got a.txt
init old.toml
    cannot write old.toml: it already exists; use --overwrite or another NAME.toml
info none.nc
    cannot read none.nc: it does not exist; give a file written by frictionmap
info folder
    cannot read folder: it is not a file; give a file written by frictionmap
info good.toml
    cannot read results from good.toml: it is a configuration; compute it first, e.g. frictionmap map good.toml
info rig.toml
    cannot read results from rig.toml: it is a configuration; compute it first, e.g. frictionmap identify rig.toml
info pulse.toml
    cannot read results from pulse.toml: it is a configuration; compute it first, e.g. frictionmap history pulse.toml
info spectra.toml
    cannot read results from spectra.toml: it is a configuration; compute it first, e.g. frictionmap spectrum spectra.toml
info typo.toml
    cannot read results from typo.toml: it is a configuration; compute it first, e.g. frictionmap map typo.toml
info foreign.nc
    cannot read foreign.nc: its source is 'not given'; give a file written by frictionmap
info binary.nc
    cannot read binary.nc: it is damaged or not NetCDF (...); give a file written by frictionmap
info map.nc --at x
    --at must be NAME=VALUE, such as damping_ratios=0.01; got 'x'
info map.nc --at zeta=1
    file map.nc: unknown axis of --at 'zeta' (did you mean beta?); valid: mu, r, beta
info map.nc --at r=5
    file map.nc: --at r must be one of r = 0.5, 1; got 5
info axes.nc --at damping_ratios=0.1 --at damping_ratios=0
    --at damping_ratios must be given once; got 0.1 and 0
plot axes.nc
    file axes.nc: cannot choose a point along damping_ratios: the file has damping_ratios = 0, 0.1; give --at damping_ratios=VALUE, or draw the shares of regimes over it with plot --over damping_ratios
plot axes.nc --at damping_ratios=0.2
    file axes.nc: --at damping_ratios must be one of damping_ratios = 0, 0.1; got 0.2
plot axes.nc --over zeta
    unknown further axis of --over 'zeta'; valid: damping_ratios
plot axes.nc --over damping_ratios --at damping_ratios=0
    cannot use --at damping_ratios with --over damping_ratios: --over takes all its points; use --at for other axes
plot map.nc -o map.jpg
    -o must end in .png, .pdf, .svg, .gif, .mp4; got map.jpg
plot ''
    cannot read .: it is not a file; give a file written by frictionmap
export ''
    cannot read .: it is not a file; give a file written by frictionmap
plot map.nc -o map.gif
    cannot write a map as a moving picture: only responses and histories move; use .png, .pdf, .svg
plot map.nc --quantity amplitude
    unknown quantity 'amplitude' in a file of kind map; valid: regimes
plot map.nc --log
    cannot draw map with log: it applies to response curves and quantities of maps; omit log
plot map.nc --size 85
    size must be a width such as 85mm or 3.3in, or a width and a height such as 85mm x 60mm, from 1 to 80 inches; got '85'
plot map.nc --size 1mm
    size must be a width such as 85mm or 3.3in, or a width and a height such as 85mm x 60mm, from 1 to 80 inches; got '1mm'
plot map.nc --dpi 1
    dpi must be >= 20; got 1.0
plot map.nc --xlim 1 0
    xlim must be increasing; got 1, 0
plot map.nc --ylim 0 nan
    ylim must be two finite numbers; got 0, nan
plot map.nc --xlim 5 6
    limits of r must overlap 0.5 to 1; got 5, 6
plot map.nc --panels 2
    panels must be 1 to 1; got 2
plot map.nc --panels 0
    panels must be >= 1; got 0
plot map.nc --panels x
    frictionmap plot: argument --panels: invalid list of numbers separated by commas value: 'x' (see frictionmap plot --help)
plot map.nc --mass 1
    cannot use mass with plot_regimes: it applies to plot_curves, plot_response, plot_orbit, plot_quantity, animate; omit mass
plot map.nc --beta 0.5
    cannot use beta with plot_regimes: it applies to plot_curves; omit beta
plot map.nc --point 3 0.5
    point must lie within r = 0.5 to 1 and beta = 0.5 to 1; got 3, 0.5
plot map.nc --box 0.1 0.1
    cannot use box without point: it is the uncertainty of a point; give point
plot map.nc --point 0.75 0.75 --box -0.1 0.1
    box must be half-widths >= 0; got -0.1, 0.1
plot map.nc --style none.mplstyle
    cannot read style none.mplstyle: No such file or directory; give a file of settings of matplotlib
plot map.nc --style good.toml
    style must be a file that ends in .mplstyle; got good.toml
fm.plot_regimes(MAP, size=(1.0,))
    size must be two numbers; got (1.0,)
fm.plot_regimes(MAP, legend=1)
    legend must be True or False; got 1
fm.plot_regimes(MAP, title=1)
    title must be text; got 1
fm.plot_regimes(MAP, panels=[])
    panels must have at least one value; got none
fm.plot_regimes(MAP, seize="85mm")
    unknown option 'seize' (did you mean size?); valid: size, dpi, legend, caption, title, xlim, ylim, panels, mass, beta, point, box
fm.plot_regimes(MAP, ax=np, size="85mm")
    cannot use size with ax: the axes have a figure already; set its size
fm.plot_quantity(MAP, "amplitud")
    unknown quantity 'amplitud' of a map; valid: none
export map.nc -o map.txt
    -o must end in .nc or .csv; got map.txt
map good.toml -o map.txt
    -o must end in .nc or .zarr; got map.txt
curves good.toml -o curves.csv
    -o must end in .nc; got curves.csv
identify rig.toml -o rig.json
    -o must end in .nc; got rig.json
design question.toml -o answer.txt
    -o must end in .nc; got answer.txt
polt map.nc
    unknown command 'polt' (did you mean plot?); valid: map, curves, response, explore, identify, design, reduce, history, spectrum, plot, export, info, init, help, setup
help polt
    unknown command 'polt' (did you mean plot?); valid: map, curves, response, explore, identify, design, reduce, history, spectrum, plot, export, info, init, help, setup
map good.toml --thread 2
    unrecognized arguments: --thread 2 (did you mean --threads?) (see frictionmap --help)
plot map.nc --no-legends
    unrecognized arguments: --no-legends (did you mean --no-legend?) (see frictionmap --help)
explore good.toml --port 99999
    frictionmap explore: argument --port: must be 0 to 65535; got 99999 (see frictionmap explore --help)
explore good.toml --export page.pdf
    --export must end in .html; got page.pdf
explore good.toml --set grid.r=-1
    grid.r must be >= 0; got -1.0 at index 0
map good.toml more
    unrecognized arguments: more (see frictionmap --help)
map good.toml --threads=x
    frictionmap map: argument --threads: invalid whole number value: 'x' (see frictionmap map --help)
map good.toml --threads -2
    frictionmap map: argument --threads: must be >= 1; got -2 (see frictionmap map --help)
map good.toml --threads 1.5
    frictionmap map: argument --threads: invalid whole number value: '1.5' (see frictionmap map --help)
map good.toml --set
    frictionmap map: argument --set: expected one argument (see frictionmap map --help)
map good.toml --set grid.q=1
    unknown key 'grid.q'; valid: r, beta, friction_coefficient, mu, wall_speed
map good.toml --set solver.outputs=regime
    solver.outputs must be a list of names; got 'regime'
map good.toml --set solver.steps=many
    solver.steps must be a whole number; got 'many'
response good.toml --r 0.5
    --beta must be given, such as --beta 0.5; got nothing
response good.toml --r nan --beta 1
    r must be finite; got nan
response good.toml --r inf --beta 1
    r must be finite; got inf
response good.toml --r -1 --beta 1
    r must be >= 0; got -1.0
boundaries good.toml --threads 2
    unrecognized arguments: --threads 2 (see frictionmap --help)
map good.toml --over
    unrecognized arguments: --over (did you mean --overwrite?) (see frictionmap --help)
map good.toml --threads 1 --threads 2
    frictionmap map: argument --threads: must be given once (see frictionmap map --help)
response good.toml --r 1 --r 2 --beta 1
    frictionmap response: argument --r: must be given once (see frictionmap response --help)
response good.toml --r 1 --beta 1 --beta 1
    frictionmap response: argument --beta: must be given once (see frictionmap response --help)
response good.toml --r 1 --beta 1 --mu 1 --mu 2
    frictionmap response: argument --mu: must be given once (see frictionmap response --help)
response good.toml --r 1 --beta 1 --set grid.mu=[1,1.5,2]
    cannot choose mu: grid.mu has 3 values, 1, 1.5, 2; give --mu
map good.toml --set grid.r=1 --set grid.r=2
    cannot apply --set grid.r=2: it undoes --set grid.r=1; give one of the two
map good.toml --set grid.r={start=0,stop=1,num=3} --set grid.r.num=5 --set grid.r=1
    cannot apply --set grid.r=1: it undoes --set grid.r={start=0,stop=1,num=3}; give one of the two
map good.toml --set grid.r={start=0,stop=1,num=3} --set grid.r.num=5 --set grid.r.step=0.5
    cannot apply --set grid.r.step=0.5: it undoes --set grid.r.num=5; give one of the two
map good.toml --set 'solver.steps=24 # of old'
    solver.steps must be a whole number; got '24 # of old'
map good.toml --set 'solver.steps=24, cycles = 5'
    solver.steps must be a whole number; got '24, cycles = 5'
map good.toml --set 'solver.steps=24 }, b = { c = 1'
    solver.steps must be a whole number; got '24 }, b = { c = 1'
map good.toml --overwrite=yes
    frictionmap map: argument --overwrite: ignored explicit argument 'yes' (see frictionmap map --help)
info map.nc -o x.txt
    unrecognized arguments: -o x.txt (see frictionmap --help)
response good.toml --beta 0.5 --r=0,5
    r must be a number; got '0,5'
plot
    frictionmap plot: the following arguments are required: FILE (see frictionmap plot --help)

# Design questions
design good.toml
    the configuration must have a table [design]; got none
design question.toml --set design.quest=stuck
    unknown key 'design.quest' (did you mean question?); valid: question, band, response, mu, beta, limit, r, spread, quantile, second, ratio
design question.toml --set design.question=best
    design.question must be one of least-peak, no-stop, stuck, at-most, margin, robust, two-forces, no-squeal, no-separation; got 'best' (did you mean robust?)
design good.toml --set design.question=stuck
    design.band must be given for question stuck; got nothing
design question.toml --set design.band=[1]
    design.band must be two frequencies; got 1
design question.toml --set design.band=[0,1]
    design.band must be > 0; got 0
design question.toml --set design.band=[2,1]
    design.band must be two increasing frequencies; got 2 to 1
design question.toml --set 'design.band=["1 Hz","2 Hz"]'
    cannot convert design.band = ['1 Hz', '2 Hz'] to ratios: a reference value is missing; give units.natural_frequency (or units.mass with units.stiffness), such as units.natural_frequency = "4.2 Hz"
design question.toml --set design.mu=0.9
    design.mu must be >= 1; got 0.9
design question.toml --set design.beta=[0.5]
    design.beta must be two friction ratios; got 1
design question.toml --set design.response=phase
    design.response.quantity must be one of amplitude, first_harmonic, contact, transmitted_force; got 'phase'
design question.toml --set design.response={mass=2}
    design.response.mass must be <= 1; got 2
design question.toml --set design.response={masses=1}
    unknown key 'design.response.masses' (did you mean mass?); valid: quantity, mass, contact
design question.toml --set design.response=1
    design.response must be a table of quantity, mass, contact; got 1
design question.toml --set design.response=first_harmonic --set system.contact_stiffness=2.0
    cannot use design.response.quantity 'first_harmonic' with several contacts, springs, belts or loads of several harmonics: it is not computed; use one of amplitude, contact
design question.toml --set design.question=robust --set design.spread=1
    design.spread must be < 1; got 1
design question.toml --set design.question=robust --set design.spread=0
    design.spread must be > 0; got 0
design question.toml --set design.question=at-most
    design.limit must be given for question at-most; got nothing
design question.toml --set design.question=at-most --set design.limit=0
    design.limit must be > 0; got 0
design question.toml --set design.question=at-most --set design.limit=0.01 --set system.contact=joined-base-wall --set system.excitation=base --quiet
    design.limit must be >= 1 Y, the least peak, at beta = ...; got 0.01
design question.toml --set design.question=no-stop --set system.contact_stiffness=2.0
    [design]: cannot find friction without stops with contact_stiffness: a spring in the contact has no such limit; use question stuck
design question.toml --set design.question=no-separation
    [design]: cannot find a preload without a contact whose normal force moves with the structure: others never open; give contacts[1].normal
design question.toml --set design.question=stuck --set 'system.springs=[{gap=0.5,stiffness=2.0}]'
    [design]: cannot find friction that holds with piecewise linear springs or contacts without friction: the friction that holds has no closed form there; compute a map, or use question at-most
design question.toml --set design.question=no-stop --set 'system.springs=[{gap=0.5,stiffness=2.0}]'
    [design]: cannot find friction without stops with springs: no limit of it is known there; compute a map of stops_per_cycle
design question.toml --set 'system.springs=[{gap=0.5,stiffness=2.0}]'
    design.beta must be two friction ratios with piecewise linear springs or contacts without friction: the friction that holds has no closed form there; got none
design question.toml --set design.question=margin --set design.r=0 --set design.beta=1
    design.r must be > 0; got 0
design question.toml --set design.question=margin --set design.beta=1
    design.r must be given for question margin; got nothing
design question.toml --set axes.damping_ratios=[0.1]
    design.question must be robust in a configuration with [axes], whose points are samples; got least-peak
design question.toml --set design.question=robust --set axes.damping_ratios=[0.1] --set design.spread=0.1
    cannot use design.spread with [axes]: their samples take its place; leave one of them out; got 0.1
design question.toml --set design.question=robust --set axes.damping_ratios=[0.1] --set design.quantile=1.5
    design.quantile must be <= 1; got 1.5
design question.toml --set design.question=robust --set design.quantile=0.9
    cannot use design.quantile without [axes]: it is one over their samples; add [axes] or leave it out; got 0.9

# Measured data: configurations
identify none.toml
    cannot read configuration none.toml: No such file or directory; give the path of a TOML file
identify free-decay.csv
    cannot read a configuration from free-decay.csv: it is a data file; give a RIG.toml that names it under data.file
identify good.toml
    cannot identify from a configuration with [grid]: it describes a map; use frictionmap map, or give [data] with kind, one of free-decay, forced, record, sweep, loop
identify empty.toml
    the configuration must have a table [data] with kind, one of free-decay, forced, record, sweep, loop; got none
identify rig.toml --set data.kind=decay
    data.kind must be one of free-decay, forced, record, sweep, loop; got 'decay' (did you mean free-decay?)
identify rig.toml --set data.file=none.csv
    cannot read none.csv: No such file or directory; check data.file
identify rig.toml --set data.file=none.csv -o old.nc --overwrite
    cannot read none.csv: No such file or directory; check data.file
identify rig.toml --set data.file=1
    data.file must be the path of a file of measured data; got 1
identify rig.toml --set data.file=rig.doc
    data.file must end in .csv, .txt, .tsv, .dat, .asc, .npz, .mat, .json, .uff, .unv, .tdms; got rig.doc
identify rig.toml --set data.file=unsorted.csv
    file unsorted.csv, column time_s, line 4 must be > 0.2, the time of the previous row; got 0.1 (sort the rows)
identify rig.toml --set data.file=ragged.csv
    cannot read ragged.csv, line 3: expected 2 values, one per column; got 1
identify rig.toml --set data.file=words.csv
    file words.csv, column x_mm, line 3 must be a finite number; got 'high' (1 of 2 rows have none; at most 1% may be ignored)
identify rig.toml --set data.file=bare.csv
    file bare.csv, column time: its name must end in a unit, _s, _ms, _us, _min; got none (or write columns = { time = { name = "time", unit = "s" } } below [data])
identify rig.toml --set data.fil=a.csv
    data.kind = 'free-decay': unknown key 'data.fil' (did you mean file?); valid: kind, file, columns, decimal, missing, window, filter, ac_coupling_Hz, mask_s
identify rig.toml --set data.missing=ignore
    data.missing must be one of refuse, drop; got 'ignore'
identify rig.toml --set data.columns=x
    data.columns must be a table of column names, such as { time = "time_s", x = "x_mm" }; got 'x'
identify rig.toml --set 'data.columns={y="x_mm"}'
    unknown key 'data.columns.y'; valid: time, x
identify rig.toml --set 'data.columns={x="y_mm"}'
    cannot read free-decay.csv: column y_mm (suffixes: _mm, _m, _um, _in, _cm, _ft, _m_s, _mm_s, _cm_s, _in_s, _m_s2, _mm_s2, _g, _cm_s2, _in_s2, _deg, _rad, _mrad) is missing, named by data.columns.x; the file has time_s, x_mm (did you mean x_mm?)
identify rig.toml --set data.window=[1]
    file free-decay.csv, columns time_s and x_mm: window must be two times; got [1]
identify rig.toml --set data.window=[50,60]
    file free-decay.csv, columns time_s and x_mm: window must hold samples, which lie between 0 and 3.995 s; got 50 to 60
identify rig.toml --set data.window=[0,0.1]
    file free-decay.csv, columns time_s and x_mm: cannot estimate damping: record too short, fewer than 3 extrema in 21 samples; measure more cycles
identify rig.toml --set known.mu=1
    data.kind = 'free-decay': unknown key 'known.mu'; valid: f_n, zeta, x_F, X0, t0, centre, offset, base_mm, stiffness
identify rig.toml --set known.zeta=1.2
    file free-decay.csv, columns time_s and x_mm: known.zeta must be < 1 for a decay with turning points; got 1.2
identify rig.toml --set known.f_n=0
    file free-decay.csv, columns time_s and x_mm: known.f_n must be > 0; got 0.0
identify rig.toml --set 'known.f_n="3 mm"'
    known.f_n must be a number with a unit of frequency (Hz, kHz, rad/s, rpm), such as '4.2 Hz'; got '3 mm': mm is a unit of length
identify rig.toml --set 'known={f_n=3,zeta=0,x_F=0.1,X0=9,t0=0,centre=0}'
    file free-decay.csv, columns time_s and x_mm: known must leave at least one parameter free; got all of f_n, zeta, x_F, X0, t0, centre
identify rig.toml --set 'fit.free=["f_n"]'
    cannot hold zeta: its value is missing; add zeta to fit.free or known.zeta to [known]
identify rig.toml --set 'fit.free=["mass"]'
    fit.free[0] must be one of f_n, zeta, x_F, X0, t0, centre, offset; got 'mass'
identify rig.toml --set known.f_n=3 --set 'fit.free=["f_n","zeta","x_F","X0","t0","centre"]'
    cannot fit f_n: [known] holds it; remove it from fit.free or from [known]
identify rig.toml --set fit.drift=1
    file free-decay.csv, columns time_s and x_mm: drift must be true or false; got 1
identify rig.toml --set fit.loss=huber
    file free-decay.csv, columns time_s and x_mm: loss must be one of linear, soft_l1; got 'huber'
identify forced.toml --set system.excitation=force
    system.damping_reference must be ground for a force-excited structure; got 'base'
identify forced.toml --set 'data.use=["lag"]'
    data.use[0] must be one of phase, amplitude; got 'lag'
identify forced.toml --set data.use=lag
    data.use must be a list of phase, amplitude; got 'lag'
identify forced.toml --set 'data.columns={set="test"}'
    file forced.csv: cannot assign rows to sets: there is no column 'test'; correct data.columns.set
identify forced.toml --set system.damping_ratios=0.1 --set known.zeta=0.1
    file forced.csv: cannot use known.zeta: the system defines its damping; omit one of the two
identify sweep.toml --set system.masses=0
    system.masses must be >= 1; got 0
identify sweep.toml --set 'fit.free=["gamma"]'
    cannot use fit.free for this kind of data: all parameters not in [known] are fitted; omit it
identify sweep.toml --set data.sigma_phase_deg=1
    file sweep.csv, columns frequency_Hz, amplitude_ratio_1: cannot use sigma_phase without phase_lag: there are no lags; omit it
identify sweep.toml --set known.gama=1
    data.kind = 'sweep': unknown key 'known.gama' (did you mean gamma?); valid: f_k1m1, gamma, kappa, mass_ratio_2, mass_ratio_3, mass_ratio_4, mass_ratio_5, stiffness_ratio_2, stiffness_ratio_3, stiffness_ratio_4, stiffness_ratio_5, zeta_1, zeta_2, zeta_3, zeta_4, zeta_5
identify record.toml --set known.gain=0
    file ..., columns ...: known.gain must be > 0; got 0.0
identify record.toml --set system.contact_masses=[2]
    system.contact_masses must be [1] for a record of one mass; got [2]
identify record.toml --set system.zeta=0.1
    unknown key 'system.zeta'; valid: contact, damping_reference, excitation, contact_masses
identify record.toml --set 'data.columns={base="x_mm",x="base_mm"}'
    file record.csv, columns time_s, x_mm and base_mm: x must lag behind the base by 0 to 180 degrees; got a lead of 25.22 (are the columns exchanged, or is one of opposite sign?)
identify rig.toml --set known.beta=0.2
    data.kind = 'free-decay': unknown key 'known.beta' (did you mean zeta?); valid: f_n, zeta, x_F, X0, t0, centre, offset, base_mm, stiffness
identify rig.toml --set known.f_n=-3
    file free-decay.csv, columns time_s and x_mm: known.f_n must be > 0; got -3.0
identify rig.toml --set known.stiffness=0
    file free-decay.csv, columns time_s and x_mm: stiffness must be > 0; got 0.0
identify rig.toml --set 'fit.free=[]'
    fit.free must be a list of parameters; got []
identify rig.toml --set 'data.columns={ x = 3 }'
    data.columns must be a table of column names, such as { time = "time_s", x = "x_mm" }; got {'x': 3}
identify rig.toml --set 'data.columns={ y = "y_mm" }'
    unknown key 'data.columns.y'; valid: time, x
identify rig.toml --set 'data.window=[1, nan]'
    file free-decay.csv, columns time_s and x_mm: window must be finite; got nan at index 1
identify rig.toml --set fit.loss=cauchy
    file free-decay.csv, columns time_s and x_mm: loss must be one of linear, soft_l1; got 'cauchy'
identify rig.toml --set grid.r=1
    data.kind = 'free-decay': unknown key 'grid'; valid: title, data, known, fit
identify rig.toml --set system.contact=fixed-wall
    data.kind = 'free-decay': unknown key 'system'; valid: title, data, known, fit
identify forced.toml --set data.sigma_phase_deg=0
    data.sigma_phase_deg must be > 0; got 0
identify forced.toml --set system.contact=wall
    system.contact must be one of fixed-wall, joined-base-wall, between-masses; got 'wall' (did you mean fixed-wall?)
identify forced.toml --set system.masses=2
    system.masses must be a list of numbers with a unit of mass, such as ['2 kg']; got 2
identify forced.toml --set known.mu=0.9
    file forced.csv: known.mu must be >= 1; got 0.9
identify forced.toml --set known.x_F=1
    data.kind = 'forced': unknown key 'known.x_F'; valid: beta, f_n, zeta, mu, contact_stiffness, delay, gain, stiffness
identify forced.toml --set known.mu=1.2 --set known.contact_stiffness=3
    file forced.csv: mu must be 1 for a contact with a spring, which would jump at break-away; got 1.2
identify forced.toml --set system.contact_stiffness=2 --set known.contact_stiffness=3
    file forced.csv: cannot use known.contact_stiffness: the system defines it; omit one of the two
identify forced.toml --set 'fit.free=["beta"]'
    cannot hold f_n: its value is missing; add f_n to fit.free or known.f_n to [known]
identify forced.toml --set 'data.columns={ lag = "phase_lag_deg" }'
    unknown key 'data.columns.lag' (did you mean phase_lag?); valid: frequency, frequency_ratio, phase_lag, amplitude_ratio, x, base, sigma_phase, sigma_amplitude, set
identify sweep.toml --set system.masses=6
    system.masses must be <= 5; got 6
identify sweep.toml --set system.damping_reference=wall
    file sweep.csv, columns frequency_Hz, amplitude_ratio_1: system.damping_reference must be one of ground, base; got 'wall'
identify sweep.toml --set fit.cost=linear
    file sweep.csv, columns frequency_Hz, amplitude_ratio_1: fit.cost must be one of logarithmic, relative; got 'linear'
identify sweep.toml --set known.gamma=-1
    file sweep.csv, columns frequency_Hz, amplitude_ratio_1: known.gamma must be > 0; got -1.0
identify sweep.toml --set known.mass_ratio_2=1
    file sweep.csv, columns frequency_Hz, amplitude_ratio_1: known must be one of f_k1m1, gamma, kappa; got 'mass_ratio_2'
identify sweep.toml --set system.stiffness=3
    unknown key 'system.stiffness'; valid: masses, excitation, damping_reference
identify sweep.toml --set system.excitation=shaker
    system.excitation must be one of base; got 'shaker'
identify sweep.toml --set data.sigma_amplitude=0
    file sweep.csv, columns frequency_Hz, amplitude_ratio_1: data.sigma_amplitude must be > 0; got 0
identify sweep.toml --set 'data.window=[1, 2]'
    data.kind = 'sweep': unknown key 'data.window' (did you mean kind?); valid: kind, file, columns, decimal, missing, sigma_amplitude, sigma_phase_deg
identify sweep.toml --set known.mu=1
    data.kind = 'sweep': unknown key 'known.mu'; valid: f_k1m1, gamma, kappa, mass_ratio_2, mass_ratio_3, mass_ratio_4, mass_ratio_5, stiffness_ratio_2, stiffness_ratio_3, stiffness_ratio_4, stiffness_ratio_5, zeta_1, zeta_2, zeta_3, zeta_4, zeta_5
identify record.toml --set system.contact=between-masses
    system.contact must be one of fixed-wall, joined-base-wall; got 'between-masses'
identify record.toml --set system.excitation=force
    system.excitation must be one of base; got 'force'
identify record.toml --set known.mu=0.9
    file record.csv, columns time_s, base_mm and x_mm: known.mu must be >= 1; got 0.9
identify record.toml --set known.zeta=-0.1
    file record.csv, columns time_s, base_mm and x_mm: known.zeta must be >= 0; got -0.1
identify record.toml --set known.f_n=0
    file record.csv, columns time_s, base_mm and x_mm: known.f_n must be > 0; got 0.0
identify record.toml --set known.beta=0.2
    data.kind = 'record': unknown key 'known.beta' (did you mean zeta?); valid: f_n, zeta, x_F, mu, contact_stiffness, delay, gain, offset_x, stiffness
identify record.toml --set 'data.columns={ z = "z_mm" }'
    unknown key 'data.columns.z'; valid: time, base, x
identify record.toml --set 'data.window=[3, 4]'
    file record.csv, columns time_s, base_mm and x_mm: time must span at least 2 cycles of the base; got 0.99 (1 s at 0.9926 Hz)

# Python: systems, maps, responses
fm.System(contact="wall")
    contact must be one of fixed-wall, joined-base-wall, between-masses; got 'wall' (did you mean fixed-wall?)
fm.System(mass_ratios=[1, 1], stiffness_ratios=[1])
    stiffness_ratios must have as many values as mass_ratios (2); got 1
fm.System(matrices=5)
    matrices must be the path of an .npz file or a mapping with arrays M, K and optionally C; got 5
fm.System(matrices={"M": np.eye(2), "K": np.full((2, 2), np.nan)})
    matrices: K must be finite; got nan at [0, 0]
fm.System(matrices={"M": 1j * np.eye(2), "K": np.eye(2)})
    matrices: M must be an array of real numbers; got numbers of type complex128
fm.System(matrices={"M": np.eye(2), "K": np.eye(2), "dofs": [2, 2]})
    matrices: dofs must be 2 different integers >= 1, or names; got [2, 2]
fm.Solver(cycles=0)
    cycles must be >= 1; got 0
fm.Solver(outputs="regime")
    outputs must be a list of names; got 'regime'
fm.Units()
    units must have at least one of natural_frequency, load, base_amplitude, base_acceleration, acceleration_frequency, stiffness, mass, normal_force; got none
fm.Units(load="1")
    load must be a number with a unit of force (N, mN, kN, lbf), such as '12.5 N'; got '1': it has no unit
fm.sweep("system", [1.0], [0.5])
    system must be a frictionmap.System; got 'system'
fm.sweep(ONE, [], [0.5])
    r must have at least one value; got none
fm.sweep(ONE, [[1.0]], [0.5])
    r must be one-dimensional; got 2 dimensions
fm.sweep(ONE, [1.0, 0.5], [0.5])
    r must be increasing; got 0.5 at index 1
fm.sweep(ONE, [1.0], [-0.5])
    beta must be >= 0; got -0.5 at index 0
fm.sweep(ONE, [1.0], [0.5], [0.5])
    mu must be >= 1; got 0.5 at index 0
fm.sweep(ONE, ["1 Hz"], [0.5])
    cannot convert r = ['1 Hz'] to ratios: a reference value is missing; give units.natural_frequency (or units.mass with units.stiffness), such as units.natural_frequency = "4.2 Hz"
fm.sweep(ONE, [1.0], [0.5], start="sliding")
    start must be one of rest, moving; got 'sliding'
fm.sweep(ONE, [1.0], [0.5], step=9)
    unknown setting 'step' (did you mean steps?); valid: start, cycles, tolerance, steps, skip, steady, outputs
fm.sweep(ONE, [1.0], [0.5], threads=0)
    threads must be >= 1; got 0
fm.sweep(ONE, [1.0], [0.5], axes={"zeta": [0.1]})
    axes must name a number of the system, i counted from 1: damping_ratios, load_mass, frequency_scale, stiffness_scale, contact_stiffness, wall_velocity, wall_speed, mass_ratios[i], stiffness_ratios[i], damping_ratios[i], dampers[i], load[i], contact_masses[i], contacts[i].force, contacts[i].ratio, contacts[i].mu, contacts[i].stiffness, contacts[i].wall_velocity, contacts[i].wall_speed, contacts[i].normal.preload, contacts[i].normal.stiffness, contacts[i].normal.friction; got 'zeta'
fm.sweep(ONE, [1.0], [0.5], axes={"damping_ratios": [-0.1, 0.1]})
    axes, at damping_ratios = -0.1: damping_ratios must be >= 0; got -0.1
fm.sweep(ONE, [1.0], [0.5], axes={"regime": {"load_mass": [1]}})
    cannot name a further axis regime: a map has this name already; use another one
fm.sweep(ONE, [1.0], [0.5], progress=1)
    progress must be a function of two numbers; got 1
fm.curves(ONE, [1.0], [0.5], harmonics=-1)
    harmonics must be >= 0; got -1
fm.curves(ONE, [1.0], [0.5], quantities=["phase_lag"])
    quantities must be one of amplitude, phase, first_harmonic, energy, harmonics, transmitted_force, distortion, drift, acceleration_amplitude, base_force; got 'phase_lag' (did you mean phase?)
fm.curves(ONE, [1.0], [0.5], quantities=[])
    quantities must name at least one of amplitude, phase, first_harmonic, energy, harmonics, transmitted_force, distortion, drift, acceleration_amplitude, base_force; got none
fm.response(ONE, 0, 0.5)
    r must be > 0: at r = 0 there is no motion in time; got 0
fm.response(ONE, 1.0, np.inf)
    beta must be finite; got inf
fm.response(ONE, 1.0, 0.5, mu=0.9)
    mu must be >= 1; got 0.9
fm.boundaries(ONE, [1e-12])
    r must be 0, or >= 1e-06 for this system: below, a period of the load has more than 10^6 periods of the fastest free motion; got 1e-12
fm.shares(5, "sample")
    ds must be an xarray.Dataset; got int
fm.shares(MAP, "sample")
    unknown further axis of maps 'sample'; valid: none
fm.plot_regimes(5)
    ds of plot_regimes must be a dataset such as sweep returns, over mu, r and beta; got int
fm.plot_regimes(BOUNDARIES)
    ds of plot_regimes must be a dataset such as sweep returns, over mu, r and beta; got one such as boundaries returns, over mu and r (use plot_boundaries)
fm.explore(ONE, r=1.0)
    r must be a range of two numbers, or more; got 1
fm.explore(ONE, title=1)
    title must be text; got 1
fm.explore(ONE, port=-1)
    port must be >= 0; got -1

# Python: measured data
fm.identify.free_decay([0.0, 1.0], [1.0])
    x must be 2 numbers, one per time; got [1.0]
fm.identify.free_decay([1.0, 0.0], [1.0, 0.0])
    time must be increasing; got 0.0 at index 1
fm.identify.free_decay(TIME, np.ones(400))
    cannot fit x: it does not move by more than its resolution (0); check the data
fm.identify.free_decay(TIME, np.sin(1e3 * TIME))
    cannot fit x: sampling rate too low, 2 samples per cycle, 8 needed; sample faster
fm.identify.free_decay(TIME, np.exp(TIME) * np.cos(20 * TIME))
    cannot fit x as a free decay: its amplitude grows (swings grow from 2.541 to 94.18); choose a window of one decay
fm.identify.free_decay(TIME, DECAY, unit="inch")
    unit must be one of mm, m, um, in, cm, ft, m/s, mm/s, cm/s, in/s, m/s^2, mm/s^2, g, cm/s^2, in/s^2, deg, rad, mrad; got 'inch' (did you mean in?)
fm.identify.free_decay(TIME, DECAY, known={"mass": 1.0})
    known must be one of f_n, zeta, x_F, X0, t0, centre; got 'mass'
fm.identify.free_decay(TIME, DECAY, known={"zeta": -0.1})
    known.zeta must be >= 0; got -0.1
fm.identify.free_decay(TIME, DECAY, drift=1)
    drift must be true or false; got 1
fm.identify.forced([1.0, 2.0])
    phase_lag or amplitude_ratio must be given; got neither
fm.identify.forced([1.0, 2.0], [10.0])
    phase_lag must be 2 numbers, one per frequency; got [10.0]
fm.identify.forced([1.0, -2.0], [10.0, 20.0])
    frequency must be finite and > 0; got -2 at index 1
fm.identify.forced([1.0, 2.0], [10.0, 230.0])
    phase_lag at index 1 must be 0 to 180 deg for the loaded mass; got 230 (is it a lead, or another mass?)
fm.identify.forced([1.0, 2.0], [10.0, 20.0])
    cannot determine f_n: phase data alone do not determine it, and the lags of mass 1 do not pass 90 deg; give known.f_n or amplitudes
fm.identify.forced([1.0, 2.0], [10.0, 20.0], known={"beta": 0.1, "f_n": 3.0, "zeta": 0.0, "mu": 1.0})
    known must leave at least one parameter free; got all of beta, f_n, zeta, mu
fm.identify.forced([1.0, 2.0], [10.0, 20.0], free="beta")
    free must be a list of parameters; got 'beta'
fm.identify.forced([1.0, 2.0], [10.0, 20.0], free=["beta"])
    cannot hold f_n: its value is missing; add f_n to free or to known
fm.identify.forced([1.0, 2.0], [10.0, 20.0], free=["beta", "f_n", "zeta", "mu", "contact_stiffness"])
    cannot fit mu together with contact_stiffness: a contact with a spring is defined for mu = 1 only; remove mu from free
fm.identify.forced([1.0, 2.0], [10.0, 20.0], known={"contact_stiffness": 0.0})
    known.contact_stiffness must be >= 0.001; got 0.0
fm.identify.forced([1.0, 2.0], [10.0, 20.0], system=fm.System(contact_stiffness=[1.0, 2.0]))
    contact_stiffness must be one number to identify friction; got a bank of 2
fm.identify.forced([1.0, 2.0], [10.0, 20.0], system=fm.System(contact_stiffness=2.0, wall_velocity=0.1))
    cannot identify friction of a system with wall_velocity: this is offered for one rigid contact under one harmonic load; omit wall_velocity
fm.identify.record(TIME, np.cos(4 * TIME), np.cos(4 * TIME), known={"contact_stiffness": 1e5})
    known.contact_stiffness must be <= 10000; got 100000.0
fm.identify.record(TIME, np.cos(4 * TIME), np.cos(4 * TIME), known={"contact_stiffness": 3.0, "mu": 1.1})
    mu must be 1 for a contact with a spring, which would jump at break-away; got 1.1
fm.identify.forced([1.0, 2.0], [10.0, 20.0], known={"f_n": 3.0}, unreachable="keep")
    unreachable must be one of refuse, drop; got 'keep'
fm.identify.record(TIME, np.cos(4 * TIME), np.ones(400))
    cannot fit x: it does not move by more than its resolution (0); check the data
fm.identify.record(TIME, np.cos(2 * TIME), np.cos(2 * TIME))
    time must span at least 2 cycles of the base; got 1.2 (3.99 s at 0.3125 Hz)
fm.identify.record(TIME, np.cos(4 * TIME), np.cos(4 * TIME + 1.0))
    x must lag behind the base by 0 to 180 degrees; got a lead of 57.3 (are the columns exchanged, or is one of opposite sign?)
fm.identify.record(TIME, np.cos(4 * TIME), np.cos(4 * TIME), contact="wall")
    contact must be one of fixed-wall, joined-base-wall; got 'wall' (did you mean fixed-wall?)
fm.identify.sweep([1.0, 2.0], [1.0])
    amplitude_ratio of mass 1 must be 2 numbers, one per frequency; got [1.0]
fm.identify.sweep([1.0, 2.0], [1.0, -1.0])
    amplitude_ratio of mass 1 must be finite and > 0; got -1.0 at index 1
fm.identify.sweep([1.0, 2.0, 3.0], [1.0, 2.0, 1.0])
    frequency must have more values than unknowns, 3; got 3
fm.identify.sweep([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 1.0, 0.5])
    amplitude_ratio must have two peaks for two frequencies; got one peak
fm.identify.sweep([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 1.0, 0.5], masses=6)
    masses must be <= 5; got 6
fm.identify.sweep([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 1.0, 0.5], sigma_phase=1.0)
    cannot use sigma_phase without phase_lag: there are no lags; omit it
fm.identify.sweep([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 1.0, 0.5], cost="linear")
    cost must be one of logarithmic, relative; got 'linear'
fm.identify.joint([(TIME, DECAY)])
    data must be two or more measurements, each (time, x) of a decay or (time, base, x) of a record; got ...
fm.identify.joint([(TIME, DECAY), (TIME,)])
    data 2 must be (time, x) of a decay or (time, base, x) of a record; got ...
fm.identify.joint([(TIME, DECAY)] * 2, labels=["a", "a"])
    labels must be 2 different names, one for each of data; got ['a', 'a']
fm.identify.displacements(TIME, DECAY, DECAY, x_unit="kg")
    x_unit must be one of mm, m, um, in, cm, ft, m/s, mm/s, cm/s, in/s, m/s^2, mm/s^2, g, cm/s^2, in/s^2; got 'kg'
fm.identify.friction_ratio(-1.0, 10.0)
    r must be > 0; got -1
fm.identify.friction_ratio([1.0, 2.0], 10.0)
    phase_lag must be 2 numbers, one per frequency; got 1
fm.identify.log_likelihood(5)
    ds must be a dataset of estimates; got 5
fm.identify.log_likelihood(MAP)
    cannot evaluate the likelihood: ds has no variable estimate; give a dataset of identify

# The page
?colums=5
    unknown key 'colums'; valid: r, beta, mu, start, contact, damping_ratios
?mu=1&mu=2
    mu must be given once; got '1' and '2'
?mu=one
    mu must be a number; got 'one'
?mu=0.5
    mu must be >= 1; got 0.5
?r=1
    r must be two numbers separated by a comma; got '1'
?r=1,0
    r must be increasing; got 0.0 at index 1
?start=sliding
    start must be one of rest, moving; got 'sliding'
?contact=floor
    contact must be one of fixed-wall:1, joined-base-wall:1; got 'floor'
?damping_ratios=-1
    damping_ratios must be >= 0; got -1.0
"""  # noqa: E501


def entries():
    """The calls and messages of the table."""
    found = []
    for line in TABLE.splitlines():
        if line.startswith("    "):
            found[-1][1] = line.strip()
        elif line and not line.startswith("# "):
            found.append([line, ""])
    return [tuple(entry) for entry in found]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the files of the table."""
    folder = tmp_path_factory.mktemp("refusals")
    for name in ("forced", "sweep", "record"):
        shutil.copy(ROOT / f"configs/rigs/{name}.toml", folder)
        shutil.copy(ROOT / f"configs/rigs/{name}.csv", folder)
    shutil.copy(ROOT / "configs/rigs/free-decay.toml", folder / "rig.toml")
    shutil.copy(ROOT / "configs/rigs/free-decay.csv", folder)
    for name, text in {
        "good.toml": "[system]\n[grid]\nr = 1.0\nbeta = { start = 0.0, stop = 1.0, step = 0.5 }\n",
        "question.toml": "[system]\ndamping_ratios = 0.05\n[design]\nband = [0.5, 1.5]\n",
        "pulse.toml": '[system]\n[record]\npulse = { kind = "half-sine", amplitude = 1.0, duration = 3.0 }\n'
        "[history]\nfriction = 0.1\n",
        "spectra.toml": "[record]\n[spectrum]\nperiod = 1.0\nfriction = 0.1\n",
        "empty.toml": "",
        "typo.toml": "a =\n",
        "old.toml": "",
        "old.nc": "",
        "old.zarr": "",
        "rig.doc": "",
        "frame.mtx": f"{BANNER} real symmetric\n2 2 3\n1 1 2.0\n2 1 -1.0\n2 2 1.0\n",
        "short.mtx": f"{BANNER} real symmetric\n2 2 3\n1 1 2.0\n",
        "bad.mtx": f"{BANNER} complex general\n1 1 1\n1 1 1.0 0.0\n",
        "unsorted.csv": "time_s,x_mm\n0.0,1.0\n0.2,0.5\n0.1,0.2\n",
        "ragged.csv": "time_s,x_mm\n0.0,1.0\n0.2\n",
        "words.csv": "time_s,x_mm\n0.0,1.0\n0.2,high\n",
        "bare.csv": "time,x\n0.0,1.0\n",
    }.items():
        (folder / name).write_text(text)
    (folder / "latin.toml").write_bytes('title = "é"'.encode("latin-1"))
    (folder / "binary.nc").write_bytes(b"\x89HDF\r\n")
    for name in ("folder", "folder.zarr"):
        (folder / name).mkdir()
    (folder / "folder.zarr/notes.txt").write_text("")
    xr.Dataset({"regime": ("x", [1.0])}).to_netcdf(folder / "foreign.nc")
    _map().to_netcdf(folder / "map.nc")
    several = _map().expand_dims(damping_ratios=[0.0, 0.1])
    several.to_netcdf(folder / "axes.nc")
    return folder


BANNER = "%%MatrixMarket matrix coordinate"


def _map():
    """A map of four cells, without any computation."""
    axes = {"mu": [1.0], "r": [0.5, 1.0], "beta": [0.5, 1.0]}
    coords = {name: coordinate(name, np.array(values)) for name, values in axes.items()}
    regime = label_variable("regime", np.full((1, 2, 2), 2, dtype=np.int8))
    return xr.Dataset({"regime": regime}, coords, {"source": "frictionmap", "title": "map"})


def _boundaries():
    coords = {
        name: coordinate(name, np.array(values)) for name, values in {"mu": [1.0], "r": [0.5, 1.0]}.items()
    }
    limit = label_variable("beta_lim", np.ones((1, 2)))
    return xr.Dataset({"beta_lim": limit}, coords, {"source": "frictionmap", "title": "boundaries"})


def _names():
    """What expressions of the table may use."""
    time = np.arange(400) / 100.0
    decay = np.exp(-0.3 * time) * np.cos(20.0 * time)
    return {
        "fm": fm, "np": np, "ONE": fm.System(), "MAP": _map(), "BOUNDARIES": _boundaries(),
        "TIME": time, "DECAY": decay,
    }  # fmt: skip


def message_of(call):
    """The message of a refused call."""
    if call.startswith("?"):
        scene = scene_of_system(fm.System(), (0.0, 2.5), (0.0, 2.0), 1.0, "rest", "map", None)
        with pytest.raises(fm.InputError) as caught:
            read_query(scene, call[1:])
        return str(caught.value)
    if call.startswith("fm."):
        with pytest.raises(fm.InputError) as caught:
            eval(call, _names())
        return str(caught.value)
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = main(shlex.split(call))
        except SystemExit as ended:  # of argparse
            status = ended.code
    assert status == 2
    assert (out.getvalue(), err.getvalue().count("\n")) == ("", 1)
    return err.getvalue().removeprefix("frictionmap: ").rstrip("\n")


def matches(message, expected):
    """Whether a message is as expected, where three dots stand for any text."""
    return re.fullmatch(".*".join(map(re.escape, expected.split("..."))), message) is not None


@pytest.mark.parametrize(("call", "expected"), entries(), ids=[call for call, _ in entries()])
def test_a_mistake_is_refused_in_one_line(folder, monkeypatch, call, expected):
    monkeypatch.chdir(folder)
    before = sorted(folder.rglob("*"))
    message = message_of(call)
    assert matches(message, expected), message
    assert sorted(folder.rglob("*")) == before


def test_messages_of_the_table_have_one_of_the_forms():
    of_argparse = r"(frictionmap \w+: (argument|the following arguments) |unrecognized arguments: ).*"
    for call, expected in entries():
        assert any(re.fullmatch(form, expected) for form in (*FORMS, of_argparse)), call


def _template(node):
    """The text of a message in the source, with {} for what is filled in."""
    if isinstance(node, ast.Constant):
        return str(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(_template(part) for part in node.values)
    return "{}"


def templates():
    """The messages of all errors of input in the package, with their places."""
    for path in sorted((ROOT / "frictionmap").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id == "InputError"
            ):
                text = " ".join(map(_template, node.args)).replace(" :", ":")
                yield f"{path.relative_to(ROOT)}:{node.lineno}", text


#: Parts of the package whose callers know an argument by another name, such as system.mu.
RENAMED = re.compile(
    r"frictionmap/(model/|structures/|units/|design/|theory/|general/|steady/|checks\.py|stop_counts/dataset)"
)


def test_messages_about_an_argument_carry_its_name():
    """Else `renamed` cannot name it as the caller does: the message must not begin with the name itself."""
    for path in sorted((ROOT / "frictionmap").rglob("*.py")):
        if RENAMED.match(path.relative_to(ROOT).as_posix()):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and ast.unparse(node.func) == "InputError":
                    texts = [*map(_template, node.args)]
                    named = re.match(r"(cannot use )?(\{\}|[\w.\[\]]+)+(:| must) ", texts[0])
                    assert len(texts) > 1 or not named, f"{path.name}:{node.lineno}: {texts[0]}"


def test_errors_are_renamed_and_placed():
    one = fm.InputError("mu", "must be >= 1; got 0.5")
    assert (str(one), one.where) == ("mu must be >= 1; got 0.5", "mu")
    assert str(one.renamed("grid.mu")) == "grid.mu must be >= 1; got 0.5"
    other = fm.InputError("cannot use", "load", "with waveform: both define the load; omit one")
    assert str(other.renamed("system.load")) == (
        "cannot use system.load with waveform: both define the load; omit one"
    )
    assert str(fm.InputError("matrices", ": K must be finite; got nan")).startswith("matrices: K must")
    assert fm.InputError("cannot fit x: too short; add samples").where == ""
    again = pickle.loads(pickle.dumps(other))
    assert (str(again), again.where) == (str(other), "load")


def test_every_message_in_the_package_has_one_of_the_forms():
    wrong = [
        f"{place}: {text}"
        for place, text in templates()
        if not any(re.fullmatch(form, text, re.DOTALL) for form in (*FORMS, *PASSED_ON))
    ]
    assert not wrong, "\n".join(wrong)
