"""
Two and five masses
===================

In a chain every mode has its own resonance, in which the contact may or may not take part. The positions of
the contact and of the load matter more than the friction force.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 6.7**, two masses, contact and load on the first. Undamped chains with mu > 1 have wide
# regions of irregular motion. Stops there are averages over the cycles followed.
fm.plot_regimes(computed("fig-6-7"))

# %%
# **T Fig. 6.14**, contact on the second mass. It slides easily at both resonances.
fm.plot_regimes(computed("fig-6-14"))

# %%
# **T Fig. 6.10** and **6.17**, five masses, contact on the first and on the third.
fm.plot_regimes(computed("fig-6-10"))
fm.plot_regimes(computed("fig-6-17"))

# %%
# **T Fig. 6.24**, contact between two masses, and **6.26**, between the first mass and the shaken base.
fm.plot_regimes(computed("fig-6-24"))
fm.plot_regimes(computed("fig-6-26"))

# %%
# The rig of T section 6.4.
fm.plot_regimes(computed("rig"))
