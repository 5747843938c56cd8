"""A stranger's laboratory: a beam between two jaws, by somebody who had not read the library.

Nothing here imports anything of it.

- `specimen`: bricks with incompatible modes, a beam and its jaws in contact over two faces; modes
  of a reduced basis, over contact stiffness, tension, tip mass and a crack.
- `friction`: sliders of four distributions and Bouc-Wen's hysteresis, by first harmonic.
- `laws`: what is hidden, and how it acts on load, contact, frequency and curves. Sizes are drawn.
- `bench`: the campaign: loads, passes, clampings, times, operators, scatter, noise.
- `signal`: velocity of a record by slow flow, and what is wrong with records.
- `files`: sheet, campaign file, matrices or table of frequencies as an analyst would give them.
- `plan`: what a seed hides, of which kind, under which simulation.

Specimens are of steel, 0.2 to 0.3 m long, flap, edge and torsion modes; the true modulus is off by
0.7 %, each mode by 0.12 % besides, contact scatters by 2 to 6 % between clampings (normal, or
Student's t with 3 degrees in 30 %). Loads act as tension in half of the campaigns. Four to eight
loads of 2 to 22 kN, some passes one way, an incomplete sheet in 35 %; hammer, release or shaker.
"""
