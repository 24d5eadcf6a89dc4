"""Files: reading of configurations and datasets, atomic writing, summaries.

===========  ==================================================================
module       what is in it
===========  ==================================================================
keys         the keys of a configuration: meaning, default, valid values
variants     CSV files of numbers that change together, for further axes
config       configurations (TOML): read, overridden, checked key by key
json_schema  the keys as JSON Schema, for editors
template     commented configurations to begin with
places       output files: claimed before the work, written whole or not at all
storage      datasets as NetCDF files
slices       one point of further axes, chosen from a file
estimates    estimates: read, checked, in words
reading      files and stores read, and checked against the schema
stored       system, excitation and start that a dataset was made with
summary      what a dataset holds, in words
studies      files with further axes, and stores, in words
export       slices of files as NetCDF or as a table
===========  ==================================================================
"""
