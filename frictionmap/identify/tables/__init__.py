"""Files of measured data as tables of named columns with units.

=========  ================================================================
module     what is in it
=========  ================================================================
lab_files  files of measuring programs (UFF, TDMS), through the extra `lab`
files      CSV, MAT and NPZ files, and those of `lab_files`
columns    columns by role, with their units, checked value by value
=========  ================================================================
"""
