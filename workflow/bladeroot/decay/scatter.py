"""How much the blocks of a record really scatter, against the error assumed for them."""

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.decay.phasors import Phasors


def noise_ratio(blocks: Phasors, window: int = 7, reach: int = 30) -> Float[ndarray, " block"]:
    """Observed over assumed standard error of the blocks, running along the record.

    From the scatter of either part about a local cubic: coloured noise, remains of other modes
    and a wrong noise level all show here.
    """
    window = min(window, blocks.time.size)
    y = np.stack([blocks.log.real, blocks.log.imag])
    value, leverage = local_cubic(blocks.time, y, blocks.std, window)
    square = ((y - value) / blocks.std) ** 2 / (1.0 - leverage)
    reach = min(reach, (blocks.time.size - 1) // 2)
    padded = np.pad(square, ((0, 0), (reach, reach)), mode="reflect")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=1)
    return np.sqrt(
        np.median(around.transpose(1, 0, 2).reshape(square.shape[1], -1), axis=1) / 0.4549
    )


def local_cubic(
    time: Float[ndarray, " block"],
    y: Float[ndarray, "part block"],
    std: Float[ndarray, " block"],
    window: int,
) -> tuple[Float[ndarray, "part block"], Float[ndarray, " block"]]:
    """Weighted cubic through the `window` blocks around each block: its value there, leverage.

    Rows of `y` share times and errors. Windows at the ends shift inwards. The leverage is the
    weight of a block in its own fitted value.
    """
    own = np.arange(time.size)
    start = np.clip(own - window // 2, 0, time.size - window)
    index = start[:, None] + np.arange(window)
    distance = time[index] - time[:, None]
    x = distance / np.abs(distance).max(axis=1, keepdims=True)
    power = x[:, :, None] ** np.arange(4)
    trust = (std[index].min(axis=1, keepdims=True) / std[index]) ** 2
    weighted = power * np.maximum(trust, 1e-6)[:, :, None]
    gram = weighted.transpose(0, 2, 1) @ power + 1e-12 * np.eye(4)
    weight = np.linalg.solve(gram, weighted.transpose(0, 2, 1))[:, 0]
    # subtracting the local level keeps the digits of a long phase
    value = ((y[:, index] - y[:, :, None]) * weight).sum(axis=2) + y
    return value, np.clip(weight[own, own - start], 0.0, 0.9)
