"""Arrays only: frames and log-phasors of one mode, spectral lines, envelopes, smoothing splines.

In: samples and a sampling frequency. Out: arrays. Nothing here knows a file, a sheet or a finding.
Read `phasors` first (from samples to independent log-phasors), then `smooth` (a curve and its
derivatives from noisy values). Tapers and spectral lines are those of `lines`, frames in which a
decay is looked for those of `envelope`, where it turns `turning`; `recording` is what a sensor gave
and makes a velocity of it.
"""
