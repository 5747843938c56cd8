"""
A ring-down of your own
=======================

One record to its curves of frequency and damping over amplitude, and its stick frequency.

The record is simulated here: a mode at 210 Hz whose joint slips above a micrometre, so that it softens
and damps more. With a file it would be ``br.ringdown("blow.wav", mode_Hz=210, sensitivity="500 mm/s/FS")``.
"""

import bladeroot as br
import numpy as np

# %%
# The decay is integrated cycle by cycle from the law that we then look for.

rate, onset = 8192, 1e-6  # Hz, m
time = np.arange(5 * rate) / rate
amplitude, phase = np.empty(time.size), np.empty(time.size)
here, angle = 2e-5, 0.0
for k in range(time.size):
    amplitude[k], phase[k] = here, angle
    slipping = max(1.0 - onset / here, 0.0)
    omega = 2.0 * np.pi * 210.0 * (1.0 - 0.01 * slipping)
    loss = 0.003 + 0.006 * slipping
    here *= np.exp(-0.5 * loss * omega / rate)
    angle += omega / rate
velocity = -amplitude * np.gradient(phase, time) * np.sin(phase)
velocity += 3e-6 * np.random.default_rng(1).standard_normal(time.size)

# %%
# An array needs its sampling frequency, and SI units unless ``unit`` says otherwise.

decay = br.ringdown(velocity, mode_Hz=208.0, sampling_Hz=rate)
decay

# %%
# The curves are an xarray Dataset with standard errors; the plateau at small amplitudes is the stuck joint.
# Their loss factor is less than the one above by what the rise of the frequency does to the amplitude (3.11),
# 0.5 % at most.

decay.plot()

# %%
# A decay swings at 210 Hz where the joint sticks; its natural frequency is lower by what damping takes (3.11).

frequency, error = decay.stick_frequency
natural = 210.0 * np.sqrt(1.0 - (0.5 * 0.003) ** 2)
print(f"stuck at {frequency:.5f} +- {error:.5f} Hz; drawn with {natural:.5f} Hz")
