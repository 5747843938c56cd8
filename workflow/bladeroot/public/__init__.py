"""The public face: what a notebook needs, on top of all other rooms. Read `decay` first.

In: files, arrays, matrices. Out: small result objects that hold xarray Datasets, print as a short
table and can be plotted. The names are those of `bladeroot` itself (`bladeroot.decay`, ...).
`export` writes a campaign's results as CSV, MATLAB and universal file.
"""
