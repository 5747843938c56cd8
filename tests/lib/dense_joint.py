"""The joint's modes by dense matrices and solutions, which others are compared with."""

import numpy as np
import scipy.linalg
import xarray as xr
from bladeroot.rom.assembly import gap_rows
from jaxtyping import Float
from numpy import ndarray


def contact_matrices(
    assembly: xr.Dataset, equal_nodes: bool = False
) -> tuple[Float[ndarray, "dof dof"], Float[ndarray, "dof dof"]]:
    """Kn and Kt for one N/m of flank stiffness: contact adds k_n Kn + k_t Kt, eq. 5.3."""
    normal, slip = gap_rows(assembly, equal_nodes)
    return normal.T @ normal, slip.T @ slip


def assembly_modes(
    assembly: xr.Dataset, kn: float, kt: float, count: int = 24, equal_nodes: bool = False
) -> tuple[Float[ndarray, " mode"], Float[ndarray, "dof mode"]]:
    """Lowest `count` frequencies (Hz) and mass-normalised shapes with flank stiffness kn, kt (N/m).

    An eigenvalue below zero is given as a negative frequency.
    """
    normal, tangential = contact_matrices(assembly, equal_nodes)
    stiffness = assembly.stiffness.values + kn * normal + kt * tangential
    values, shapes = scipy.linalg.eigh(
        stiffness, assembly.mass.values, subset_by_index=[0, count - 1], driver="gvx"
    )
    return np.sign(values) * np.sqrt(abs(values)) / (2 * np.pi), shapes
