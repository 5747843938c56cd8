"""A user's mechanisms: each law is tried on a few records, and a faulty one told before any fit."""

import importlib.util
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path

import numpy as np
from jaxtyping import Float
from numpy import ndarray

from bladeroot.mechanisms.mechanism import COORDINATES, Mechanism, Points, Records, StickEffect
from bladeroot.mechanisms.own_files import own_files, try_apart
from bladeroot.rom.ritz import Ritz
from bladeroot.rom.sensitivity import Change

_RECORDS = Records(
    mode=np.array([0, 1, 0, 1]),
    force=np.array([2e3, 2e3, 2e4, 2e4]),
    sign=np.array([1.0, 1.0, -1.0, -1.0]),
    time=np.array([0.0, 200.0, 2000.0, 2200.0]),
    since=np.array([0.0, 200.0, 0.0, 200.0]),
    span=2200.0,
    hold_span=200.0,
    temperature=np.array([-2.0, -1.0, 0.5, 2.5]),
)
_POINTS = Points(
    mode=np.array([0, 0, 1, 1]),
    force=np.array([2e3, 2e4, 2e3, 2e4]),
    amplitude=np.array([1e-7, 1e-5, 1e-7, 1e-5]),
    loss=np.full(4, 4e-3),
)
# Derivatives are compared with differences.
_STEP = 1e-5  # of the prior's standard deviation, over which differences are taken
_TOLERANCE = 0.1  # of the largest derivative: a wrong sign or factor is off by more
_ROUNDING = 1e-11  # of an effect, relative

# An effect with its derivatives, whose last axis is of the parameters.
Effects = dict[str, tuple[ndarray, ndarray]]
Values = Float[ndarray, " parameter"]


def own_mechanisms(folder: str | Path) -> tuple[dict[str, Mechanism], list[str]]:
    """A user's mechanisms by their ids, without those that fail, and a line for each that does.

    Each file is tried in a process of its own first: it may end the program or never end. Raises
    ValueError if the folder is missing or a file is not Python.
    """
    own, faults = {}, []
    for path in own_files(folder):
        try:
            try_apart(partial(_read, path), path)
            one = _read(path)
        except ValueError as error:
            faults.append(" ".join(str(error).split()))
            continue
        if one.id in own:
            faults.append(f"two mechanisms have the id {one.id!r} ({path})")
            continue
        own[one.id] = one
    return own, faults


def _read(path: Path) -> Mechanism:
    spec = importlib.util.spec_from_file_location(f"mechanism_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except ValueError as error:
        raise ValueError(f"{error} ({path})") from error
    except (Exception, SystemExit) as error:
        raise ValueError(f"{type(error).__name__}: {error} ({path})") from error
    one = getattr(module, "MECHANISM", None)
    if not isinstance(one, Mechanism):
        raise ValueError(f"expected MECHANISM, a bladeroot.mechanisms.mechanism.Mechanism ({path})")
    try:
        probe(one)
    except ValueError as error:
        raise ValueError(f"law of {one.id}: {error} ({path})") from error
    return one


def probe(one: Mechanism) -> None:
    """Raise ValueError, naming hook and place, where a form's hook returns what no fit can use.

    Tried at the prior's mean, a standard deviation away from it by each parameter, as far as its
    limits allow, and at each start; derivatives are compared with differences.
    """
    for form in one.every_form:
        for hook, law in _laws(form):
            _probe(form, hook, law)


def _probe(one: Mechanism, hook: str, law: Callable[[Values], Effects]) -> None:
    try:
        for coordinates in _places(one):
            values, by_coordinate = one.values(coordinates)
            _compare(one, law, values, _STEP * one.std * by_coordinate)
    except Exception as error:  # whatever the file's own code throws
        kind = "" if isinstance(error, ValueError) else f"{type(error).__name__}: "
        raise ValueError(f"hook {hook}: {kind}{error}") from error


def _laws(one: Mechanism) -> Iterator[tuple[str, Callable[[Values], Effects]]]:
    """The names of the mechanism's hooks and their effects at some values."""
    if one.stick is not None:
        yield "stick", lambda values: _stick(one.stick(_RECORDS, values))
    if one.damping is not None:
        yield "damping", lambda values: {"ln_loss": _pair(one.damping(_RECORDS, values))}
    if one.curve is not None:
        yield "curve", lambda values: _curve(one.curve(_POINTS, values))
    if one.structure is not None:
        yield "structure", lambda values: _structure(one.structure(_small_problem(), values))


def _stick(effect: StickEffect) -> Effects:
    changes, slopes = (_part(effect, name) for name in ("changes", "slopes"))
    if not set(changes) == set(slopes) <= set(COORDINATES):
        raise ValueError(f"changes and slopes must both be of {', '.join(COORDINATES)}")
    return {
        name: tuple(_of_records(name, part[name]) for part in (changes, slopes)) for name in changes
    }


def _curve(effect) -> Effects:
    return {
        name: (
            _of_records(name, _part(effect, name)),
            _of_records(name, _part(effect, f"{name}_slope")),
        )
        for name in ("ln_f", "loss")
    }


def _pair(made) -> tuple[ndarray, ndarray]:
    if not isinstance(made, tuple) or len(made) != 2:
        raise ValueError(f"expected the change and its derivatives, got {_named(made)}")
    return tuple(_of_records("change", part) for part in made)


def _structure(made) -> Effects:
    if not (
        isinstance(made, tuple)
        and len(made) == 2
        and isinstance(made[0], Change)
        and isinstance(made[1], list | tuple)
        and all(isinstance(part, Change) for part in made[1])
    ):
        raise ValueError(f"expected a Change and a list of its derivatives, got {_named(made)}")
    whole, parts = made
    shape, effects = _small_problem().beam.shape, {}
    for name in ("stiffness", "mass"):
        matrices = [np.asarray(getattr(one, name), float) for one in (whole, *parts)]
        for matrix in matrices:
            _agree(name, matrix, shape)
        slopes = np.stack(matrices[1:], axis=-1) if parts else np.zeros((*shape, 0))
        effects[name] = matrices[0], slopes
    return effects


def _part(effect, name: str):
    if not hasattr(effect, name):
        raise ValueError(f"expected an effect with {name}, got {_named(effect)}")
    return getattr(effect, name)


def _named(made) -> str:
    return "None" if made is None else f"a {type(made).__name__}"


def _of_records(name: str, part) -> ndarray:
    """The part as an array with an entry a record."""
    array = np.asarray(part, float)
    if array.shape[:1] != (4,):
        raise ValueError(f"{name}: expected 4 entries on 4 records, got shape {array.shape}")
    return array


def _agree(name: str, part: ndarray, shape: tuple[int, ...]) -> None:
    if part.shape != shape:
        raise ValueError(f"{name}: expected shape {shape}, got {part.shape}")
    if not np.isfinite(part).all():
        raise ValueError(f"{name}: expected finite numbers within the prior and its limits")


def _places(one: Mechanism) -> Iterator[ndarray]:
    """Coordinates of the fit: mean, starts, and a standard deviation away by each parameter."""
    yield one.start
    yield from (np.asarray(start, float) for start in one.starts)
    for k, parameter in enumerate(one.parameters):
        for aside in (-parameter.std, parameter.std):
            place = one.start.copy()
            value = np.clip(parameter.value(place[k] + aside), parameter.low, parameter.high)
            place[k] = parameter.coordinate(value)
            yield place


def _tried(law: Callable[[Values], Effects], values: Values) -> Effects:
    """The effects at some values, of the right shapes and finite."""
    effects = law(values)
    for name, (change, slopes) in effects.items():
        _agree(name, change, change.shape)
        _agree(f"derivatives of {name}", slopes, (*change.shape, values.size))
    return effects


def _compare(
    one: Mechanism, law: Callable[[Values], Effects], values: Values, step: Values
) -> None:
    """Raise ValueError for a derivative that lies outside the differences to both sides.

    A law may have a kink at a place, or a limit beyond which it is not defined: differences are
    taken where the limits allow.
    """
    effects = _tried(law, values)
    for k, parameter in enumerate(one.parameters):
        sides = [
            (place, _tried(law, place))
            for place in (values + sign * step[k] * np.eye(values.size)[k] for sign in (-1, 1))
            if parameter.low <= place[k] <= parameter.high
        ]
        for name, (change, slopes) in effects.items():
            seen = [(there[name][0] - change) / (place[k] - values[k]) for place, there in sides]
            if not seen:
                continue
            low, high, given = np.min(seen, axis=0), np.max(seen, axis=0), slopes[..., k]
            off = np.maximum(low - given, given - high)
            size = max(np.abs(seen).max(), np.abs(given).max())
            allowed = _TOLERANCE * size + _ROUNDING * np.abs(change).max() / step[k]
            if not off.max() <= allowed:
                worst = np.unravel_index(off.argmax(), off.shape)
                expected = 0.5 * (low + high)[worst]
                raise ValueError(
                    f"derivative of {name} by {parameter.name} at {values[k]:.3g} must be "
                    f"{expected:.3g} (by differences), got {given[worst]:.3g}"
                )


@cache
def _small_problem() -> Ritz:
    """A made-up mode of three vectors and one for perturbations, of usual size."""
    own = np.diag([1e7, 9e7, 3e8, 5e8])
    mixed = np.array([[2.0, 0.3, 0.1, 0.2], [0.3, 1.0, 0.2, 0.1], [0.1, 0.2, 1.5, 0.3],
                      [0.2, 0.1, 0.3, 1.2]])  # fmt: skip
    x = np.linspace(-0.14, 0.14, 9)
    display = np.zeros((x.size, 3, 4))
    display[:, 1] = np.stack([np.cos(8 * x), np.sin(15 * x), np.cos(25 * x), x], axis=1)
    return Ritz(
        beam=own,
        slots=1e6 * mixed,
        geometric=100.0 * mixed,
        springs=(0.05 * mixed, 0.1 * mixed),
        beam_mass=0.2 * mixed,
        contact=np.repeat(0.1 * mixed[None, :3], 2, axis=0),
        display=display,
        display_x=x,
        residual=np.zeros((1, 15)),
        own=3,
        rank=0,
        amplification=1.0,
    )
