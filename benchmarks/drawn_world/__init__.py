"""Ring-down records as they are measured: drawn events whose truth is known.

An event is one motion of one specimen, seen by one to four sensors. A blow (sometimes two), a
shaker that lets go, or a released load moves 3 to 6 modes, each by its own law (`laws`: thirteen
kinds), and up to three suspension modes of 0.1 to 20 % of the velocity. Amplitude and phase are
integrated along the law; a push acts on each mode in closed form; velocity and acceleration are
exact derivatives. In a fifth of the events a real friction element (Jenkins sliders or Bouc-Wen) on
one mode is integrated in time, and a mode's truth is the backbone of its own clean decay in the
same system; modes that do not keep to it beside the others are not asked for. Then come harmonics,
filters, AC coupling, cable sway, offset and drift, white and 1/f noise, mains and the digitiser.
The sheet states frequencies to 2 %. Asked for are pairs of mode and sensor that stand ten times out
of the noise at the start, have 0.3 % of the record's peak, and stay above twice the noise for 50
cycles; at most three modes.

`draw(seed)` gives the event, `campaign(event, folder)` its files and sheet, `event.truth(mode,
sensor, amplitude)` what is true.
"""

from .event import Event, draw
from .sheet import campaign

__all__ = ["Event", "campaign", "draw"]
