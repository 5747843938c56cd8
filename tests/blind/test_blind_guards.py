"""Against fooling oneself: what must change a verdict, and what must not.

All on fast cases of seeds that set no threshold and score none. Of each guard CI runs one case.
"""

import numpy as np
import pytest
from cases import draw_case
from fast import save
from lab import Laboratory
from runs import diagnose, structures
from score import score

pytestmark = pytest.mark.slow
SEED = 4400


def first(*cases):
    """The first case for CI, the others on demand."""
    rest = [
        pytest.param(*(one if isinstance(one, tuple) else (one,)), marks=pytest.mark.suite)
        for one in cases[1:]
    ]
    return [cases[0], *rest]


# Run before the diagnosis: its catalogue without one mechanism.
REMOVED = """\
import bladeroot.mechanisms.catalogue as shipped
_all = shipped.usable_catalogue


def _without(folder=None):
    found, faults = _all(folder)
    return tuple(m for m in found if m.id != {name!r}), faults


shipped.usable_catalogue = _without
"""
# A user's file that takes the shipped mechanism's place, with its law bent.
BENT = """\
from dataclasses import replace
from bladeroot.mechanisms.{module} import MECHANISM as shipped


def bent(records, *values):
    return shipped.{hook}(replace(records, {field}={law}), *values)


MECHANISM = replace(shipped, {hook}=bent, forms=())
"""
SHUFFLED = """\
import random
import bladeroot.mechanisms.catalogue as shipped
_all = shipped.usable_catalogue


def _shuffled(folder=None):
    found, faults = _all(folder)
    return tuple(random.Random({seed}).sample(list(found), len(found))), faults


shipped.usable_catalogue = _shuffled
"""


@pytest.fixture(scope="module")
def structure(tmp_path_factory):
    return structures(tmp_path_factory.mktemp("house"))


@pytest.fixture(scope="module")
def lab(structure):
    return Laboratory(structure / "reduced.nc")


@pytest.fixture(scope="module")
def case_of(lab):
    """Observations of a case, made once for all tests."""
    made = {}

    def of(names, relative=3.0, number=0):
        key = names, relative, number
        if key not in made:
            case = draw_case(SEED + number, names, relative)
            made[key] = case, lab.fast(case)
        return made[key]

    return of


@pytest.fixture
def verdict_on(structure, tmp_path):
    def of(seen, **options):
        save(seen, tmp_path / "observations.nc")
        return diagnose(tmp_path / "observations.nc", structure / "parametric.nc", **options)

    return of


def names(verdict):
    """What a verdict says is there for certain."""
    return {
        cause["mechanism"]
        for cause in verdict["causes"]
        if verdict["answer"] == "named" and len(cause["credible_set"]) == 1
    }


PAIRED = first("quadratic-drag", "load-dependent-stiffness", "drift")


def test_paired_null(case_of, verdict_on):
    """The same bench, sheet and noise without the effect: nothing."""
    case, seen = case_of(())
    assert score(case.answer(), verdict_on(seen)).column == "nothing-missing"


@pytest.mark.parametrize("name", PAIRED)
def test_paired_effect(case_of, verdict_on, name):
    """What the null of the same seed does not have is named."""
    assert names(verdict_on(case_of((name,))[1])) == {name}


# A drift has a twin where both modes have the same part in the contact: one that ages with time.
@pytest.mark.parametrize("name", first("loading-hysteresis", "quadratic-drag"))
def test_without_the_true_mechanism_its_name_is_not_given_to_another(case_of, verdict_on, name):
    verdict = verdict_on(case_of((name,))[1], before=REMOVED.format(name=name))
    assert verdict["probabilities"].get("none", 0.0) < 0.5
    assert not names(verdict)


@pytest.mark.parametrize(
    ("name", "label"),
    first(
        ("load-dependent-stiffness", "force"),
        ("drift", "time"),
        ("loading-hysteresis", "direction"),
    ),
)
def test_permuted_labels_lose_the_cause(case_of, verdict_on, name, label):
    """Holds keep their records; what the label says of them is dealt out anew."""
    case, seen = case_of((name,))
    holds, first = np.unique(seen["hold"].values, return_index=True)
    chance = np.random.default_rng(case.seed)
    dealt = chance.permutation(seen[label].values[first])
    given = dict(zip(holds, dealt, strict=True))
    values = np.array([given[hold] for hold in seen["hold"].values])
    if label == "time":  # a drift shows between the records of a hold, too: dealt out among them
        for hold, begin in zip(holds, seen["time"].values[first], strict=True):
            mine = seen["hold"].values == hold
            values[mine] += chance.permutation(seen["time"].values[mine] - begin)
    permuted = seen.assign({label: ("record", values, seen[label].attrs)})
    assert name not in names(verdict_on(permuted))


def test_the_catalogue_s_order_does_not_matter(case_of, verdict_on):
    seen = case_of(("incomplete-contact",), 2.0)[1]
    straight = verdict_on(seen)
    again = verdict_on(seen, before=SHUFFLED.format(seed=1))
    assert again["answer"] == straight["answer"]
    assert [c["mechanism"] for c in again["causes"]] == [c["mechanism"] for c in straight["causes"]]


@pytest.mark.parametrize("name", first("loading-hysteresis", "quadratic-drag"))
def test_evidence_grows_with_size(case_of, verdict_on, name):
    evidence = []
    for relative in (1.0, 3.0):
        verdict = verdict_on(case_of((name,), relative)[1])
        assert names(verdict) == {name}
        evidence.append(verdict["causes"][0]["log_evidence"])
    assert evidence == sorted(evidence)


@pytest.mark.parametrize(
    ("name", "hook", "field", "law"),
    first(
        ("load-dependent-stiffness", "stick", "force", "12e3 * (records.force / 12e3) ** -1.0"),
        ("drift", "stick", "time", "records.time**4 / records.span**3"),
    ),
)
def test_a_broken_formula_is_caught(case_of, verdict_on, tmp_path, name, hook, field, law):
    """With the law bent in the catalogue the true effect is not confirmed by its name."""
    case, seen = case_of((name,))
    text = BENT.format(module=name.replace("-", "_"), hook=hook, field=field, law=law)
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "own.py").write_text(text)
    verdict = verdict_on(seen, settings={"mechanisms": str(tmp_path / "own")})
    assert verdict["probabilities"].get("none", 0.0) < 0.5
    outcome = score(case.answer(), verdict)
    assert not outcome.named or outcome.parameter == 0


@pytest.mark.parametrize(
    ("name", "measurement", "std"),
    first(("modulus-density", "free-free", 0.003), ("rig-compliance", "rig stiffness", 0.02)),
)
def test_a_level_is_split_by_an_independent_measurement_alone(
    case_of, verdict_on, name, measurement, std
):
    case, seen = case_of((name,))
    assert name not in names(verdict_on(seen))
    told = {"measurement": measurement, "value": case.effects[0][1], "std": std}
    assert name in names(verdict_on(seen, settings={"independent": [told]}))


def test_a_level_that_is_named_brings_the_simulation_itself_nearer(case_of, verdict_on):
    """The model's bias, learned from other forces, would hide most of the error and of the gain."""
    gain = verdict_on(case_of(("added-mass",))[1])["gain"]
    spared, whole = gain["between_forces"], gain["between_forces_without_bias"]
    assert whole["before"] > 3.0 * spared["before"]
    assert whole["after"] < 0.5 * whole["before"]
    assert whole["after"] < 2.0 * spared["after"]


@pytest.mark.parametrize("lacking", first("holds", "records", "force", "mode"))
def test_too_little_data_is_said_to_be_too_little(case_of, verdict_on, lacking):
    # Single clampings cannot tell a gauge's gain; a drift they can, from records of one hold.
    seen = case_of(("force-gain",) if lacking == "holds" else ("drift",))[1]
    force, mode = seen["force"].values, seen["mode"].values
    keep = {
        "records": np.arange(seen.sizes["record"]) % 14 == 0,
        "force": force == force[0],
        "mode": mode == "1B",
        "holds": np.isin(seen["hold"].values, np.unique(seen["hold"].values)[:7]),
    }[lacking]
    verdict = verdict_on(seen.isel(record=np.flatnonzero(keep)))
    assert not names(verdict)
    assert verdict["answer"] == "insufficient-data" or lacking in ("mode", "holds")
