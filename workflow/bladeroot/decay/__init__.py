"""One record to frequency and damping over amplitude.

In: a recording. Out: the free decay of one mode (`free_decay`), its curves with a second opinion
and its plateau (`record`, which is the file to read first, and alone knows files). `cut` chooses a
decay, which begins by `release` and ends by `ending`; `components` takes off what else rings (far
from the mode: `component_lines`; near it: `steady`, `harmonic`, `twofold`), `track` follows the
mode (noise that shakes it: `shaken`), `freevib` makes the curves (3.1 to 3.13), `pff` the second
opinion, which `agreement` compares. What a person overrules is done in `overrides`.
"""
