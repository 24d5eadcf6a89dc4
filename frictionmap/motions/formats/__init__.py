"""Files of records: one module per format.

=========  ==========================================================================
module     what is in it
=========  ==========================================================================
series     `Series`: what is read of a file; numbers in lines of text
peer       PEER: `.AT2`, `.VT2`, `.DT2`
knet       K-NET and KiK-net: `.EW`, `.NS`, `.UD`, with or without a number
esm        ESM and ITACA: `.ASC` with a header
cosmos     COSMOS: `.V1`, `.V2`, `.V1c`, `.V2c`
seismic    miniSEED and SAC, through obspy
tables     named columns: CSV and other text, MAT, NPZ, JSON, UFF, TDMS
files      which of them reads a file
=========  ==========================================================================
"""
