"""The thesis's model of 1 degree of freedom with spring and slider (3.3): its numbers alone."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Slider:
    """Mass (kg), spring K and contact spring k_t (N/m), mu N0 (N), damping zeta; section 3.4."""

    mass: float = 0.7
    spring: float = 4.2e6
    contact: float = 4.0e6
    slip_force: float = 400.0
    zeta: float = 2.5e-3

    @property
    def stick_frequency(self) -> float:
        """Undamped frequency in full adhesion, Hz."""
        return float(np.sqrt((self.spring + self.contact) / self.mass) / (2.0 * np.pi))

    @property
    def critical_amplitude(self) -> float:
        """X_cr = mu N0 / k_t, m."""
        return self.slip_force / self.contact
