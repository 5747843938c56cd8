"""Contact stiffness from measured frequencies: any number of modes and interfaces, at one load."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from numpy import ndarray
from scipy.stats import chi2

from bladeroot.inference.least_squares import FE_BIAS, LEAST_PROBABILITY, fit_stiffness, ln_range
from bladeroot.public.joint import Joint, load_number

_CROSSING = 3.0  # errors of a frequency, nearer than which another mode changes places with it
RANGE = (1e6, 1e13)  # N/m, in which nearly all contact stiffnesses lie: two standard deviations


@dataclass(frozen=True)
class ContactFit:
    """Contact stiffness at one load, most probable (MAP) with its covariance.

    result: `stiffness` (N/m) and its `ln_std` by `parameter`; `ln_covariance`; by `mode` the
    `measured` and `fitted` frequency (Hz), `misfit` (in standard deviations of measurement and
    model together) and `jacobian` (d ln f / d ln k); by `other` the `other_stiffness` (N/m) that
    the frequencies allow besides, its `other_ln_std` and its `other_probability`, by Laplace's
    evidence of each. Attributes: `load`, `chi2`, `freedom`, `probability` of a larger chi-square,
    `log_evidence`, and `crossed`, the modes named by number that change places with another one at
    this stiffness: there the errors are too small, and shapes tell the modes apart.
    """

    joint: Joint
    result: xr.Dataset

    @property
    def kn(self) -> float:
        """Normal contact stiffness, N/m, of the only interface."""
        return self._only("kn")

    @property
    def kt(self) -> float:
        """Tangential contact stiffness, N/m, of the only interface."""
        return self._only("kt")

    @property
    def covariance(self) -> Float[ndarray, "parameter parameter"]:
        """Covariance of ln k, too narrow a region where few modes leave a bent ridge."""
        return self.result["ln_covariance"].values

    @property
    def fits(self) -> bool:
        """Whether the model gives the measured frequencies within their errors and its bias."""
        return bool(self.result.attrs["probability"] >= LEAST_PROBABILITY)

    def _only(self, name: str) -> float:
        if name not in self.result["parameter"].values:
            raise ValueError(f"several interfaces: result['stiffness'] has {self.joint.parameters}")
        return float(self.result["stiffness"].sel(parameter=name))

    def plot(self):
        """68 and 95 % regions of the first interface's (kn, kt).

        Returns:
            a Figure, none of pyplot's: `fit.plot().savefig("a.png")` saves it.
        """
        from bladeroot.figures.style import panels

        figure, ((axis,),) = panels(1, 1, 4.5, 4.0)
        values, vectors = np.linalg.eigh(self.covariance[:2, :2])
        turn = np.linspace(0.0, 2.0 * np.pi, 200)
        circle = np.array([np.cos(turn), np.sin(turn)])
        centre = np.log(self.result["stiffness"].values[:2])
        for probability in (0.68, 0.95):
            radius = np.sqrt(chi2.ppf(probability, 2))
            ring = centre[:, None] + radius * vectors @ (np.sqrt(values)[:, None] * circle)
            axis.plot(*np.exp(ring), label=f"{probability:.0%}")
        axis.plot(*np.exp(centre), "k+")
        axis.set(xscale="log", yscale="log")
        axis.set_xlabel(f"{self.joint.parameters[0]} in N/m")
        axis.set_ylabel(f"{self.joint.parameters[1]} in N/m")
        axis.legend()
        return figure

    def __repr__(self) -> str:
        """A short table."""
        found, attrs = self.result, self.result.attrs
        lines = [f"contact stiffness at a load of {attrs['load']:g}"]
        width = 1 + max(map(len, (*found["parameter"].values, *found["mode"].values)))
        for name in found["parameter"].values:
            one = found.sel(parameter=name)
            spread = np.exp(float(one["ln_std"]))
            lines.append(f"  {name:<{width}}{float(one['stiffness']):.4g} N/m, factor {spread:.2f}")
        for mode in found["mode"].values:
            one = found.sel(mode=mode)
            lines.append(
                f"  {mode:<{width}}{float(one['measured']):.6g} Hz measured, "
                f"{float(one['fitted']):.6g} fitted, {float(one['misfit']):+.1f} std"
            )
        if attrs["freedom"] > 0:
            lines.append(
                f"  chi-square {attrs['chi2']:.2f} with {attrs['freedom']} degrees of freedom"
                + ("" if self.fits else ": the model does not fit")
            )
        elif not self.fits:
            lines.append(f"  no root: misses by chi-square {attrs['chi2']:.2f}")
        if attrs["crossed"]:
            lines.append(
                f"  another mode crosses {attrs['crossed']} here, and errors are too small: name "
                "modes by their shapes"
            )
        for other in range(found.sizes["other"]):
            one = found.isel(other=other)
            values = ", ".join(
                f"{name} {k:.4g}"
                for name, k in zip(
                    found["parameter"].values, one["other_stiffness"].values, strict=True
                )
            )
            chance = float(one["other_probability"])
            lines.append(f"  or {values} N/m, with a probability of {chance:.2g}")
        return "\n".join(lines)


def fit_contact(
    joint: Joint,
    frequencies: Mapping[str, tuple[float, float]],
    load: float = 0.0,
    fe_bias: float | Mapping[str, float] = FE_BIAS,
    stiffness_range: tuple[float, float] = RANGE,
) -> ContactFit:
    """The contact stiffnesses of all interfaces that give the measured frequencies at one load.

    Args:
        joint: from `Joint.from_matrices` or `Joint.dovetail`.
        frequencies: by mode, frequency and its standard error in Hz.
        load: in the joint's unit of load.
        fe_bias: standard deviation of the model's relative error in frequency, of all modes or by
            mode; it belongs to the errors, for it moves kn and kt by tens of per cent.
        stiffness_range: N/m, two standard deviations of the prior of each stiffness (log-normal).

    With as many modes as stiffnesses the fit is exact where a root is found, and its misfit says by
    how much there is none. With more, chi-square says whether the model fits at all; with fewer,
    the prior decides along what the data leave open, and `ln_std` shows it. Modes named by number
    change places, so that other stiffnesses may give the same frequencies: they are searched for,
    and those that are not far less probable are told, as is where modes change places.

    The covariance is the curvature's at the estimate (Laplace). With one or two modes the posterior
    of (ln kn, ln kt) is a bent ridge, which an ellipse follows badly: ellipses of 95 % held 91 and
    82 % of 120 truths drawn from the prior by one mode of two lapped beams each, 93 % of 60 by two
    modes; a further mode straightens it.

    Raises:
        ValueError: what is no number or mapping, an unknown mode, an error that is not positive, a
            load of a joint that no load stiffens, a joint that is not stable, a mode that is
            nowhere found.

    >>> import numpy as np, bladeroot as br
    >>> one, other = np.array([[0, 1, 2]]), np.array([[3, 4, 5]])
    >>> pairs = br.ContactPairs(one, other, np.array([[1.0, 0.0, 0.0]]), np.ones(1))
    >>> K, apart = np.diag([3.0e6, 3.3e6, 3.6e6] * 2), np.eye(3, 6) - np.eye(3, 6, 3)
    >>> joint = br.Joint.from_matrices(K, 2.0 * np.eye(6), pairs, {"n": apart[0], "t": apart[1]})
    >>> fit = br.fit_contact(joint, {"n": (373.25, 0.05), "t": (254.15, 0.05)})
    >>> [f"{k:.2g}" for k in (fit.kn, fit.kt)], fit.fits
    (['4e+06', '9e+05'], True)
    """
    load = load_number(load)
    if not isinstance(frequencies, Mapping):
        raise ValueError(
            "frequencies must be a mapping of each mode to (frequency, standard error) in Hz, "
            f"got a {type(frequencies).__name__}"
        )
    names = tuple(frequencies)
    unknown = [name for name in names if name not in joint.modes]
    if unknown or not names:
        raise ValueError(f"modes must be among {', '.join(joint.modes)}, got {', '.join(unknown)}")
    try:
        pairs = np.array([frequencies[name] for name in names], float)
    except (TypeError, ValueError):  # a text, or some with an error and some without
        pairs = np.empty(0)
    if pairs.shape != (len(names), 2):
        raise ValueError(
            "frequencies must be (frequency, standard error) in Hz by mode, got "
            + ", ".join(f"{name}: {frequencies[name]!r}" for name in names)
        )
    value, std = pairs.T
    given = fe_bias if isinstance(fe_bias, Mapping) else dict.fromkeys(names, fe_bias)
    try:
        bias = np.array([given.get(name, np.nan) for name in names], float)
        low, high = map(float, stiffness_range)
    except (TypeError, ValueError) as error:
        raise ValueError(
            "fe_bias must be a number, or one by mode, and stiffness_range two numbers in N/m, got "
            f"{fe_bias!r} and {stiffness_range!r}"
        ) from error
    if missing := [name for name in names if name not in given]:
        raise ValueError(f"fe_bias must have a value for {', '.join(missing)}, got {fe_bias!r}")
    for text, numbers in (("frequency", value), ("its standard error", std), ("fe_bias", bias)):
        if not (np.isfinite(numbers).all() and (numbers > 0.0).all()):
            raise ValueError(f"{text} must be positive, got {numbers.tolist()}")
    if not 0.0 < low < high < np.inf:
        raise ValueError(f"stiffness_range must be 0 < low < high < inf, got {stiffness_range}")

    refused: list[ValueError] = []

    def modes_at(ln_k: ndarray) -> tuple[ndarray, ndarray, bool]:
        try:
            modes = joint.modes_at(ln_k, load, names)
        except ValueError as error:  # of a trial step: the search takes a shorter one
            refused.append(error)
            return np.full(len(names), np.nan), np.zeros((len(names), ln_k.size)), False
        return np.log(modes.frequency), joint.gradient(ln_k, modes), True

    prior = ln_range(low, high, len(joint.parameters))
    numbered = [name for name in names if not isinstance(joint.modes[name], ndarray)]
    spread = np.hypot(std / value, bias)
    made = fit_stiffness(modes_at, np.log(value), spread, prior, bool(numbered))
    found = made.fit
    if not found.state.inside:  # at no start
        raise refused[0]
    probability = made.probability
    if made.freedom <= 0:  # of a miss where there should be a root
        probability = float(chi2.sf(made.chi_square, 1))
    others = np.array([(one.parameters, one.std) for one in made.others])
    others = others.reshape(-1, 2, len(joint.parameters))
    near = joint.modes_at(found.parameters, load, names).apart < _CROSSING * spread
    crossed = [name for name, close in zip(names, near, strict=True) if close and name in numbered]
    weights = np.exp([one.log_evidence - found.log_evidence for one in made.others])
    of_other, text = ("other", "parameter"), {"units": "1"}
    result = xr.Dataset(
        {
            "stiffness": ("parameter", np.exp(found.parameters), {"units": "N/m"}),
            "ln_std": ("parameter", found.std, text),
            "ln_covariance": (("parameter", "parameter_"), found.covariance, text),
            "measured": ("mode", value, {"units": "Hz"}),
            "fitted": ("mode", np.exp(found.state.mean), {"units": "Hz"}),
            "misfit": ("mode", made.misfit, text),
            "jacobian": (("mode", "parameter"), found.state.slope, text),
            "other_stiffness": (of_other, np.exp(others[:, 0]), {"units": "N/m"}),
            "other_ln_std": (of_other, others[:, 1], text),
            "other_probability": ("other", weights / (1.0 + weights.sum()), text),
        },
        coords={"parameter": list(joint.parameters), "mode": list(names)},
        attrs={
            "load": load,
            "chi2": made.chi_square,
            "freedom": made.freedom,
            "probability": probability,
            "log_evidence": found.log_evidence,
            "crossed": ", ".join(crossed),
        },
    )
    return ContactFit(joint, result)
