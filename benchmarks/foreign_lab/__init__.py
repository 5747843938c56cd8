"""A foreign laboratory: specimens, laws and mistakes that share no code with what infers.

Only `run.py` calls the product; nothing here imports its bench, its mechanisms or its diagnosis.

- `specimen`: 30 % of the campaigns have `dovetail-HB`, with beam, slots and tension changed, the
  others one of five drawn beams with hammer-head ends in slots (Timoshenko frames, `jointed_beam`):
  steel or aluminium, second mode 700 to 1800 Hz, tangential contact 1.5 to 15 % of 1B's stiffness.
  The analyst gets the matrices of the drawing: half as many elements, dimensions off by 0.1 to
  10 %, modulus by 0.4 %, and each mode by 0.4 % besides. Every thousand seeds have their own
  specimens. Where the model cannot follow 3B it is made of 1B and 2B.
- `laws`, a file each, three to eight forms each: 18 ids of the catalogue, and twelve that no
  catalogue was known to have when they were written: clock, operators, amplifier, ageing, crack,
  loose sensor, damping over time and load, lossless softening, friction in the gauge, a bad
  clamping, a neighbour in tune.
- Sizes are log-uniform from the bound of the blind laboratory on; what changes stick frequencies is
  made larger until its rms over the records is 0.8 of what clampings scatter, or its law's largest
  size is reached. Level effects are not.
- `design`: 39 to 112 records, five to eight loads unevenly repeated, some passes one way, records
  lost; hammer or shaker, noise 40 to 80 dB, up to two unlisted modes; ln kn, ln kt scatter by 1 to
  10 % between clampings, normally or as Student's t with 3 degrees; directions partly or wholly
  missing in a quarter of the campaigns, times in 7 %.
- `motion`: slow flow of amplitude and phase, harmonics as the physics says, other modes linear, 16
  bits. Sheet, lengths and names are the same whatever is hidden.
- `curves`, the quick tier: curves with drawn errors instead of records; effects on the signal
  itself are left out.
- `further`: what a verdict asks for first, carried out on the same specimen.
- `score`: outcomes by kind and effect; log score and reliability of the verdict's `probabilities`;
  an answer without them is taken at its word with 0.95. A size is compared where the catalogue
  states it: gain and slope of ln k at 12 kN, loss a decade of time at ten minutes.

The truth lies outside of the campaign's folder, with its salted SHA-256 written before the
inference.
"""
