"""Levels of statistics that all fits share: what is beyond chance, and when an estimate has settled."""

#: Values so many standard errors from zero are no chance: what is estimated has been found.
FOUND = 3.0

#: What chance makes more rarely than this is beyond the errors that are given, or no white noise.
CHANCE = 1e-3

#: Beyond this correlation two estimates can hardly be separated.
CORRELATED = 0.95

#: Errors from residuals are found again and again until they change by less than this share, and so often at
#: most.
SETTLED, ROUNDS = 1e-3, 20

#: Residuals so many times as large as the noise, and beyond this share of the motion, are not those of the
#: motion that was to be fitted.  Higher harmonics, and friction that is not constant, leave far less.
MISFIT, MISFIT_SHARE = 10.0, 0.1
