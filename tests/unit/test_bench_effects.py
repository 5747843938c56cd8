"""Hidden effects: each changes what it says and nothing else, in the size it says."""

from dataclasses import asdict

import numpy as np
import pandas as pd
import pytest
from bladeroot.bench.conditions import baseline, moments
from bladeroot.bench.joint import parts
from rig_toy import toy_bench, toy_reduced
from tuning import cause_of, conditions_of, effect, ids

# The classes that the diagnosis answers with; `outside` is in no catalogue.
CLASSES = {
    "amplitude": {
        "cubic-softening",
        "joint-slip",
        "normal-load-variation",
        "geometric-hardening",
        "quadratic-drag",
    },
    "force-law": {
        "force-dependent-damping",
        "load-dependent-stiffness",
        "incomplete-contact",
        "force-gain",
    },
    "level": {"force-offset", "added-mass", "modulus-density", "rig-compliance"},
    "time": {"step-change", "drift", "force-relaxation", "damping-drift", "ageing"},
    "direction": {"loading-hysteresis"},
    "record": {"clipping", "shaker-recontact", "mode-beating", "mains-hum"},
}
CHANGES = {
    "joint-slip": {"friction"},
    "normal-load-variation": {"preload"},
    "geometric-hardening": {"hardening"},
    "quadratic-drag": {"drag"},
    "load-dependent-stiffness": {"kn", "kt"},
    "incomplete-contact": {"kn", "kt"},
    "force-gain": {"force"},
    "force-offset": {"force"},
    "added-mass": {"added_mass"},
    "modulus-density": {"modulus"},
    "rig-compliance": {"slot"},
    "drift": {"modulus"},
    "force-relaxation": {"force"},
    "loading-hysteresis": {"kn", "kt"},
    "clipping": {"clipped"},
    "shaker-recontact": {"touched", "touched_at"},
    "mode-beating": {"beating", "beating_ratio"},
    "mains-hum": {"hum"},
    "cubic-softening": {"tangential_cubic"},
    "damping-drift": {"loss"},
    "force-dependent-damping": {"loss"},
    "step-change": {"kn", "kt"},
    "spell": {"kn", "kt"},
    "ageing": {"kn", "kt"},
    "mode-coupling": {"oscillator", "oscillator_Hz", "oscillator_loss"},
}
PLACES = {"added_mass_x", "hum_Hz"}


def sheet():
    rows = []
    for hold, (direction, bar) in enumerate([("up", 20), ("up", 67), ("down", 134), ("down", 67)]):
        for k in range(6):
            rows.append(
                {
                    "record": f"r{hold}{k}",
                    "mode": "1B" if k % 2 else "2B",
                    "hold": f"h{hold}",
                    "direction": direction,
                    "pressure_bar": bar,
                    "time_s": 5000 * hold + 180 * k,
                }
            )
    return pd.DataFrame(rows)


def with_effect(name, size):
    return conditions_of(toy_bench(), sheet(), [(name, size)])


def test_the_catalogue_is_complete():
    found = {name: effect(name).CLASS for name in ids()}
    for kind, names in CLASSES.items():
        assert {name for name, own in found.items() if own == kind} == names
    assert sum(own == "outside" for own in found.values()) >= 2


@pytest.mark.parametrize("name", CHANGES)
def test_an_effect_changes_its_own_conditions_alone(name):
    clean = conditions_of(toy_bench(), sheet(), [])
    changed = set()
    for before, after in zip(clean, with_effect(name, effect(name).BOUND), strict=True):
        one, two = asdict(before), asdict(after)
        changed |= {key for key in one if one[key] != two[key]}
    assert CHANGES[name] <= changed <= CHANGES[name] | PLACES


def test_an_unknown_effect_is_refused():
    with pytest.raises(ValueError, match="got 'magic'"):
        effect("magic")


def test_sizes_of_the_laws():
    rows = sheet()
    clean = conditions_of(toy_bench(), rows, [])
    reading = np.array([moment.reading for moment in moments(toy_bench(), rows)])

    def ratio(name, size, field):
        after = with_effect(name, size)
        return np.array(
            [getattr(a, field) / getattr(b, field) for a, b in zip(after, clean, strict=True)]
        )

    force = np.array([true.force for true in clean])
    np.testing.assert_allclose(ratio("load-dependent-stiffness", 0.3, "kt"), (force / 12e3) ** 0.3)
    np.testing.assert_allclose(ratio("incomplete-contact", 4e3, "kn"), 1 - np.exp(-force / 4e3))
    np.testing.assert_allclose(ratio("force-gain", 0.1, "force"), 1 + 0.1 * reading / force)
    modulus = ratio("drift", 2e-3, "modulus")
    assert (modulus[0], modulus[-1]) == pytest.approx((1.0, 1.004))
    kept = ratio("force-relaxation", 0.01, "force")
    np.testing.assert_allclose(kept[[0, 1, 5]], 1 - 0.01 * np.log10([1, 4, 16]))
    hysteresis = ratio("loading-hysteresis", 0.2, "kn")
    np.testing.assert_allclose(hysteresis[[0, -1]], [0.9, 1.1])
    bedding = ratio("ageing", 0.5, "kn")
    np.testing.assert_allclose(bedding[[0, 6, 12]], [1, 2**0.5, 3**0.5])
    step = ratio("step-change", 0.2, "kn")
    assert set(np.round(step, 12)) == {0.8, 1.0}
    assert (np.diff(step) <= 0).all()
    spell = ratio("spell", 0.2, "kn")
    assert set(np.round(spell, 12)) == {0.8, 1.0}
    assert spell[0] == spell[-1] == 1.0


def test_a_tuned_cause_has_the_effect_that_was_asked_for():
    bench, whole = toy_bench(friction={"coefficient": np.inf}), parts(toy_reduced())
    row = {"record": "r1", "mode": "1B", "hold": "h1", "pressure_bar": 20}
    highest = {"1B": 2e-5}
    weak, strong = (
        cause_of(bench, whole, [row], highest, "joint-slip", size) for size in (1e-3, 4e-3)
    )
    assert strong < weak < 30
    assert cause_of(bench, whole, [row], highest, "drift", 0.01) == 0.01
    with pytest.raises(ValueError, match="cannot reach"):
        cause_of(bench, whole, [row], highest, "joint-slip", 10.0)
    assert baseline(bench, row).friction == np.inf


@pytest.mark.parametrize("law", [("load-dependent-stiffness", 0.6), ("incomplete-contact", 4e3)])
def test_the_joint_answers_to_the_force_that_there_is(law):
    relaxed = ("force-relaxation", 0.02)
    one, other = (
        conditions_of(toy_bench(), sheet(), pair) for pair in ((law, relaxed), (relaxed, law))
    )
    alone = conditions_of(toy_bench(), sheet(), [law])
    assert one == other
    assert any(a.kn < b.kn for a, b in zip(one, alone, strict=True))
