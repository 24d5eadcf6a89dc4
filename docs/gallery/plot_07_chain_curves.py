"""
Chains: amplitude and phase
===========================

Every mass has its own curve, and so has the contact.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 6.6**, contact on the first of two masses; **6.13**, on the second.
fm.plot_curves(computed("fig-6-6"))
fm.plot_curves(computed("fig-6-13"))

# %%
# Invariant points are marked.  All curves of a mass meet there, because friction does not affect the
# amplitude.
#
# **T Fig. 6.23**, contact between the masses; **6.25**, a wall joined to the base.
fm.plot_curves(computed("fig-6-23"))
fm.plot_curves(computed("fig-6-25"))

# %%
# **T Fig. 6.2**, three masses, contact on the second. Each resonance becomes finite at its own
# friction ratio, T(6.2): 0.436, 1.765 and 0.630.
fm.plot_curves(computed("fig-6-2"))

# %%
# **T Fig. 6.8 and 6.9b**, five masses, contact and load on the first; **6.15 and 6.16b**, contact on the
# third.
fm.plot_curves(computed("fig-6-8"))
fm.plot_curves(computed("fig-6-15"))
