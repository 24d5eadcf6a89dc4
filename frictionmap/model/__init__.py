"""Systems: structure, damping, load and contact; their matrices and modes; settings of the solver.

==================  ===================================================================================
module              what is in it
==================  ===================================================================================
html                short descriptions for notebooks
shown               short texts of settings
settings            settings of the solver and of response curves; names of the outputs
periodic_load       loads of several harmonics: waveforms, tables, samples
friction_law        friction over the sliding speed: break points, formulas brought to that form
normal_contact      normal force that moves with the structure, with separation
spring_element      piecewise linear springs: gaps, backlash, bilinear springs
contact             a contact with its spring, belt and normal load
points              points of a structure given by modes, and its residual flexibility
general             systems with several contacts or harmonics: checks, parallel contacts, loops
sizes               sizes of steady states that a design is about
phasors             complex arrays as pairs of real ones, which are rounded alike at any position
damped_oscillators  a damped structure as oscillators that do not depend on r
free_structure      the sliding structure as oscillators
balance             linear response at many frequencies, free or held
modes               modes, participation factors of contact and load, the structure held at its contact
rigid_modes         structures that no spring holds at a place
matrices            mass, stiffness and damping matrices: small, dense, definite
decoupling          the error of neglecting the damping that couples modes
coupled_modes       structures whose damping couples their modes: responses to loads
given_modes         structures that are given by modes: their definition, the argument `modes` of a system
system              `System`: structure, damping, load, contact, and their valid values
sectors             cyclic structures: a ring of sectors, each given once
variations          further axes of a study: parameters of a system that vary
held_structure      the structure held at its contact as oscillators
==================  ===================================================================================
"""
