"""What comes in: raw files of any format, their units, and a campaign's description and sheet.

In: paths. Out: a `Recording` in SI units (`read`), a checked `Campaign` (`campaign`), a line for
every fault. Read `campaign` first for sheets, `read` for raw files, which compares file and sheet;
`recording` makes SI units and fills lost samples, `sampling` tells a rate from a column of times. A
format is one file of `readers`, a unit or a sensitivity is understood by `units`, what sensors of a
quantity do to the motion is undone by `velocity` in `signal.recording`, and a sensor's own response
or filter is one file of `responses`. `facts` says which keys of a campaign a record, the
observations and the diagnosis get; `load` is what a campaign varies, `table` a simulation given as
a sheet.
"""
