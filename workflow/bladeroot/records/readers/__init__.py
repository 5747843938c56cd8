"""One file a format: SUFFIXES and read(path, quantity, unit, channel, sampling_Hz)."""
