"""The closed marginal likelihood is that of the Gaussian model written out."""

import numpy as np
import pytest
from bladeroot.plateau.evidence import fits, framed, sums
from bladeroot.plateau.laws import (
    DOUBT_STDS,
    FACTOR_NODES,
    HINGE_SHAPES,
    hats,
    hinge_laws,
    smooth_laws,
)
from bladeroot.plateau.segment import grouped
from scipy.stats import multivariate_normal


def segment_of(noise):
    """A decay whose frequency leaves a constant at ln A = -1, straight in A."""
    rng = np.random.default_rng(3)
    time = np.linspace(0.0, 1.0, 240)
    log = -3.0 * time
    slipping = np.minimum(time, 1.0 / 3.0)
    slipped = (np.e - np.exp(1.0 - 3.0 * slipping)) / 3.0 - slipping  # of e = A / A0 - 1
    y = np.stack([log, 40.0 * time - 2.0 * slipped])
    std = np.full(time.size, noise)
    return grouped(time, y + noise * rng.standard_normal(y.shape), std, log, most=60)


@pytest.mark.parametrize("noise", [1e-1, 1e-3])
@pytest.mark.parametrize("excess", [1.0, 2.5])
def test_evidence_of_laws_is_that_of_the_model_written_out(noise, excess):
    segment = segment_of(noise)
    frame = framed(segment)
    laws = smooth_laws(segment).joined(hinge_laws(segment, np.array([-2.0, -1.0])))
    middle = 0.5 * (segment.log[1:] + segment.log[:-1])
    found = fits(frame, sums(frame, laws), 1, excess)
    unit = np.eye(segment.time.size)
    for law in (0, 4, 8, 12, 20):
        cells = hats(middle, laws.first[law : law + 1])[0] * laws.shape[law]
        x = frame.seen(np.vstack([cells, laws.between[law]]))[0].T / np.sqrt(excess)
        y = frame.y[1] / np.sqrt(excess)
        whole = x[:, :FACTOR_NODES].sum(axis=1)
        square = (whole @ y / (whole @ whole)) ** 2
        wide = max(square, segment.time.size / (whole @ whole))
        for k, doubt in enumerate(DOUBT_STDS):
            prior = (square * doubt**2 + 1e-12 * wide) * np.eye(FACTOR_NODES + 1)
            prior[:FACTOR_NODES, :FACTOR_NODES] += wide
            model = multivariate_normal(cov=unit + x @ prior @ x.T)
            gain = model.logpdf(y) - multivariate_normal(cov=unit).logpdf(y)
            assert found.evidence[law, k] == pytest.approx(gain, rel=1e-6, abs=1e-6)


def test_the_true_shape_has_the_highest_evidence():
    segment = segment_of(1e-4)
    onsets = np.array([-1.5, -1.0, -0.7])
    frame = framed(segment)
    found = fits(frame, sums(frame, hinge_laws(segment, onsets)), 1, 1.0)
    best = int(np.argmax(found.evidence[:, 0]))  # by laws taken nearly at their word
    assert onsets[best // HINGE_SHAPES] == -1.0
    assert best % HINGE_SHAPES == 1  # straight in A above the onset
