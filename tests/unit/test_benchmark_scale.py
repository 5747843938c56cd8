"""The campaigns of the benchmark of scale are sound, and their records are what they say."""

import scale
from bladeroot.decay.record import from_file
from bladeroot.io.campaign import load_campaign


def test_a_campaign_is_sound_and_a_record_of_it_is_analysed(tmp_path):
    campaign = load_campaign(scale.make_campaign(tmp_path / "some", 9))
    assert len(campaign.records) == 9
    assert not campaign.warnings
    assert {row["hold"] for row in campaign.records} == {"h0", "h1"}
    row = campaign.records[0]
    mode = campaign.description["modes"][row["mode"]]
    known = {**row, **mode, "other_modes_Hz": [520.0], "simulated": False}
    _, curves, plateau = from_file(
        campaign.folder / row["file"],
        known,
        {"end": "noise"},
        {"damping": "hysteretic"},
    )
    # the plateau lies below a tenth of the start, at 1 + 0.01 ln(4 / 12) times 180 Hz
    assert abs(float(plateau["stick_frequency"]) / (180.0 * 0.98901) - 1.0) < 2e-3
    assert float(curves["frequency"].min()) < 0.998 * float(plateau["stick_frequency"])
