"""What comes in: raw files of any format, their units, and a campaign's description and sheet.

In: paths. Out: a `Recording` in SI units (`read`), a checked `Campaign` (`campaign`), a line for
every fault. Read `campaign` first for sheets, `read` for raw files; a format is one file of
`readers`, a unit or a sensitivity is understood by `units`, and what a sensor does to the motion
(what it integrates, its drift) is undone by `velocity` in `recording`.
"""
