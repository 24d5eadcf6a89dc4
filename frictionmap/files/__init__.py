"""Files: reading of configurations and datasets, atomic writing, summaries.

===========  ===============================================================================
module       what is in it
===========  ===============================================================================
key          one key: meaning, default, valid values as JSON Schema
keys         the keys of a configuration: meaning, default, valid values
variants     CSV files of numbers that change together, for further axes
config       configurations (TOML): read, overridden, checked key by key
json_schema  the keys as JSON Schema, for editors
template     commented configurations for a start
special      short configurations of belts without a load, contacts that open, modes, beams, rings
places       output files: reserved before the computation, written completely or not at all
storage      datasets as NetCDF files
checksums    checksums of stores: of their chunks, and of the files that describe their arrays
slices       one point of further axes, selected from a file
estimates    estimates: read, checked, summarised
motions      motions in time: read, checked, summarised
belts        motions without a load: read, checked, summarised
designs      answers to design questions: read, checked, summarised
reading      files and stores read, and checked against the schema
opening      `open`: a file or store as a dataset
stored       system, excitation and initial state of a dataset
summary      summary of a file, in words
in_json      summary of a file as JSON, for scripts
studies      summaries of files with further axes, and of stores
short_tables  one row per instant of a motion, or per frequency of response curves
export       slices of files as NetCDF or as a table
===========  ===============================================================================
"""
