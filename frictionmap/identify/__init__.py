"""Identification of friction, damping and frequencies from measured data, with standard errors.

===============  =======================================================================
module           what is in it, in the order in which data flows
===============  =======================================================================
lab_tables       files of measuring programs, through the extra `lab`
tables           files of measured data: CSV, MAT, NPZ, and those
columns          columns by role, checked value by value
integration      displacements from velocities and accelerations, harmonic by harmonic
turning_points   extremes of a record, its noise, the linear decrement
decay_checks     checks of records of free decays
decay_motion     the exact decay and its derivatives
least_squares    least squares with bounds, standard errors, intervals, correlations
robust           least squares in which outliers have little weight
phasors          harmonics of a record, by least squares on one frequency
cautions         warnings about any fit
correlation      inflation of standard errors by correlated residuals
decay_problem    least squares of a record on the exact decay
decay_starts     starting values, for each number of half cycles before rest
decay_fit        the decays nearest to all samples
decay_wander     a slow wander of the measured zero
decay_errors     errors of decays that the noise cannot distinguish
estimates        estimates as a dataset
free_decay       `free_decay`: from arrays to estimates
two_masses       two masses without friction in closed form
chain_response   response of a chain of masses without friction, and its derivatives
chain_inverse    a chain from resonances and antiresonances of its first mass
chain_sides      search on both sides of samples for resonances
chain_fit        the chain nearest to amplitudes and lags
chain_errors     fits of chains with unknown errors
chain_estimates  dataset of a fitted chain
sweep_data       tables of sweeps, checked
sweep            `sweep`: from amplitudes and lags over frequency to estimates
forced_model     amplitudes and lags of forced responses, and their derivatives
forced_data      tables of forced responses, checked
forced_start     starting values for forced responses
forced_fit       the steady states nearest to forced responses
lag_extremes     extremes of sampled functions on the way to zero
phase_inversion  `friction_ratio`: friction ratios from single lags
forced_lags      friction ratios from the single lags of a table
forced_told      warnings about a fit of forced responses
forced_labels    dataset of a fit of forced responses
forced           `forced`: from amplitudes and lags to estimates
orthonormal      orthonormal columns of tall matrices
record_noise     slow wander of a zero, noise near harmonics, the error of the model in it
plateaus         clipped extremes, and extremes at which a mass sticks
record_motion    exact steady motions under the measured base, and their derivatives
record_starts    starting values for records
record_fit       the steady motion nearest to all samples
static_friction  whether mu is fitted, and its interval
record_errors    standard errors of a record and of derived quantities
record_data      records, checked, with their harmonics
record_labels    results of a record without any model
record_verdict   verdict on a record, and identifiability
record           `record`: from arrays to estimates
joint_parts      decays and records as parts of one fit
joint_fit        joint fit with shared parameters
joint            `joint`: from several measurements to estimates
likelihood       the likelihood of the data of a fit, for samplers
rig              configuration of measured data, and kinds of data
rig_decay        free decays from the file of a rig
rig_forced       forced responses from the file of a rig
rig_record       records of steady motion from the file of a rig
rig_joint        several decays and records from the files of a rig
rig_sweep        sweeps from the file of a rig
configuration    configurations of rigs, for the command `identify`
rig_keys         their keys, with meanings and JSON Schema
===============  =======================================================================
"""

from .forced import forced
from .free_decay import free_decay
from .integration import displacements
from .joint import joint
from .likelihood import log_likelihood
from .phase_inversion import friction_ratio
from .record import record
from .sweep import sweep

__all__ = [
    "displacements",
    "forced",
    "free_decay",
    "friction_ratio",
    "joint",
    "log_likelihood",
    "record",
    "sweep",
]
