"""Ring-down records as they are measured: drawn events whose truth is known."""

from .event import Event, draw
from .sheet import campaign

__all__ = ["Event", "campaign", "draw"]
