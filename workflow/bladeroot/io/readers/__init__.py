"""One file a format: SUFFIXES and read(path, channel, quantity) -> Channel."""
