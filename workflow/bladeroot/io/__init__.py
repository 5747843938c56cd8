"""What comes in: raw files of any format, their units, and a campaign's description and sheet.

In: paths. Out: a `Recording` in SI units (`read`), a checked `Campaign` (`campaign`), a line for
every fault. Read `campaign` first for sheets, `read` for raw files; a format is one file of
`readers`.
"""
