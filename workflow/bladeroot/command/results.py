"""Where a campaign's results are."""

from pathlib import Path


def results_of(campaign: str) -> Path:
    """Its folder below results/, from the campaign's name or folder. ValueError without one."""
    folder = Path("results") / Path(campaign).name
    if not folder.is_dir():
        raise ValueError(f"no results here; bladeroot run {campaign} makes them ({folder})")
    return folder
