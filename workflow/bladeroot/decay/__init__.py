"""Amplitude-dependent frequency and damping of a free decay, and the stick frequencies in them."""
