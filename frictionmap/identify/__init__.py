"""From measured data to friction, damping and frequencies, with their errors.

===============  =======================================================================
module           what is in it, in the order in which data flows
===============  =======================================================================
units            units that names of columns end in
lab_tables       files of measuring programs, through the extra `lab`
tables           files of measured data: CSV, MAT, NPZ, and those
columns          columns by what they are, checked value by value
integration      displacements from velocities and accelerations, harmonic by harmonic
turning_points   extremes of a record, its noise, the linear decrement
decay_checks     which samples can be a free decay
decay_motion     the exact decay and its derivatives
least_squares    least squares with bounds, standard errors, intervals, correlations
robust           least squares in which outliers have little weight
phasors          harmonics of a record, by least squares on one frequency
cautions         what to mind of any fit, in words
decay_fit        the decay nearest to all samples
estimates        estimates as a dataset
free_decay       `free_decay`: from arrays to estimates
two_masses       two masses without friction in closed form
chain_response   response of a chain of masses without friction, and its derivatives
chain_inverse    a chain from where its first mass resonates and where it stands still
chain_sides      the sides of samples that resonances are on
chain_fit        the chain nearest to amplitudes and lags
chain_errors     such fits where errors are not known
chain_estimates  the dataset of such a fit
sweep_data       tables of sweeps, checked
sweep            `sweep`: from amplitudes and lags over frequency to estimates
forced_model     amplitudes and lags of forced responses, and their derivatives
forced_data      tables of forced responses, checked
forced_start     where the fit of forced responses begins
forced_fit       the steady states nearest to forced responses
lag_extremes     extremes of sampled functions on the way to zero
phase_inversion  `friction_ratio`: friction ratios from single lags
forced_lags      what the lags of a table tell one by one
forced_told      what to mind of such a fit, in words
forced_labels    the dataset of such a fit
forced           `forced`: from amplitudes and lags to estimates
record_motion    exact steady motions under the measured base, and their derivatives
record_starts    where their fit starts
record_fit       the steady motion nearest to all samples
record_errors    errors of that, and of what follows from it
record           `record`: from arrays to estimates
likelihood       the likelihood of the data of a fit, for samplers
rig              what a configuration says of measured data, and a kind of data of itself
rig_decay        free decays from the file of a rig
rig_forced       forced responses from the file of a rig
rig_record       records of steady motion from the file of a rig
rig_sweep        sweeps from the file of a rig
configuration    configurations of rigs, for the command `identify`
rig_keys         their keys in words and as JSON Schema
===============  =======================================================================
"""

from .forced import forced
from .free_decay import free_decay
from .integration import displacements
from .likelihood import log_likelihood
from .phase_inversion import friction_ratio
from .record import record
from .sweep import sweep

__all__ = ["displacements", "forced", "free_decay", "friction_ratio", "log_likelihood", "record", "sweep"]
