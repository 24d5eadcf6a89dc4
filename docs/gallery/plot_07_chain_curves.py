"""
Two masses: amplitude and phase
===============================

Every mass has its own curve, and so has the contact.
"""

from picture_data import computed

import frictionmap as fm

# %%
# **T Fig. 6.6**, contact on the first of two masses; **6.13**, on the second.
fm.plot_curves(computed("fig-6-6"))
fm.plot_curves(computed("fig-6-13"))

# %%
# Points that no friction moves are marked: there all curves of a mass meet.
#
# **T Fig. 6.23**, contact between the masses; **6.25**, a wall joined to the base.
fm.plot_curves(computed("fig-6-23"))
fm.plot_curves(computed("fig-6-25"))
