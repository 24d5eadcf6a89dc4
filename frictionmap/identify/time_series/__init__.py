"""Records of the steady motion of one mass on a base that moves with several harmonics.

===============  ===================================================================
module           what is in it
===============  ===================================================================
motion           exact steady motions under the measured base, and their derivatives
starts           where the fit starts
static_friction  whether mu is fitted, and its interval
fit              the steady motion nearest to all samples
data             records, checked, with their harmonics
alternatives     whether the model explains a record, and what else does
errors           standard errors of the fit and of derived quantities
estimates        estimates, and how far those of other models are from them
labels           results of a record that need no model, and warnings
verdict          verdict on a record, and identifiability
part             a record as a part of a joint fit
record           `record`: from arrays to estimates
===============  ===================================================================
"""
