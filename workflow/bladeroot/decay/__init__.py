"""One record to frequency and damping over amplitude.

In: a recording. Out: the free decay of one mode (`free_decay`), its curves (`curves`), and, with
its plateau, all of it at once (`ringdown`, which is the file to read first). `cut` chooses a decay,
which begins by `release` and ends by `ending`; `components` takes off what else rings (near the
mode: `steady`, `harmonic`, `twofold`), `track` follows the mode, `freevib` makes the curves (3.1 to
3.13). Around it stands `record`, which alone knows files: it reads one, hands in what a person
overrules (`overrides`), and `estimate` adds the second opinion (`pff`).
"""
