"""Levels shared by all fits: significance, correlation, convergence and misfit."""

#: Significance: an estimate at least this many standard errors from zero differs from zero.
FOUND = 3.0

#: Significance of tests: below this probability the errors given are too small, or the noise is not white.
CHANCE = 1e-3

#: Beyond this correlation two estimates can hardly be separated.
CORRELATED = 0.95

#: Errors from residuals are iterated until they change by less than this share; largest number of rounds.
SETTLED, ROUNDS = 1e-3, 20

#: Residuals larger than this multiple of the noise and than this share of the motion show that the model does
#: not describe the data.  Higher harmonics, and friction that is not constant, leave far less.
MISFIT, MISFIT_SHARE = 10.0, 0.1
