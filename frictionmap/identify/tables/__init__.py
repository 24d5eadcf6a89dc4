"""Files of measured data as tables of named columns with units.

==========  =====================================================================
module      what is in it
==========  =====================================================================
headings    names of columns and their units, as measuring programs write them
stamps      times of day and dates as seconds
text_files  text of data loggers: what stands above the names, separators, signs
lab_files   files of measuring programs (UFF, TDMS), through the extra `lab`
files       text, MAT, NPZ and JSON files, and those of `lab_files`
even_times  times that were rounded until they repeat
columns     columns by role, with their units, checked value by value
choices     what a configuration says about columns: names, units, calibrations
==========  =====================================================================
"""
