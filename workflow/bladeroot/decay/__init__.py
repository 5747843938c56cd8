"""One record to frequency and damping over amplitude.

In: a recording. Out: the free decay of one mode (`free_decay`), its curves and its plateau
(`record`, which is the file to read first; `from_file` alone knows files, and asks for a second
opinion). `cut` chooses a decay, which begins by `release` and ends by `ending`; `components` takes
off what else rings (lines far from the mode and close modes: `component_lines`; near it: a tone
that does not decay, `steady`, a louder mode's `harmonic`, a second mode that dies before the two
beat, `twofold`), `track` follows the mode (blocks that a knock threw off get larger errors; noise
that shakes the mode: `shaken`), `freevib` makes the curves (3.1 to 3.13), whose errors hold what is
no law, too (`curve_errors`). What a person overrules is done in `overrides`.
"""
