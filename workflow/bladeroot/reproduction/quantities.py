"""The computed quantities by the name that resources/thesis/ledger.yaml calls them."""

from collections.abc import Callable
from functools import partial

from bladeroot.reproduction import measured, simulated, theoretical
from bladeroot.reproduction.entry import Computed, Evidence

QUANTITIES: dict[str, Callable[[Evidence], Computed]] = {
    "piston area": measured.piston_area,
    "largest force": measured.largest_force,
    "gauge percent": measured.gauge_percent,
    **{f"Table 5.1 {mode}": partial(measured.table_5_1, mode=mode) for mode in ("1B", "2B")},
    "mean stiffness percent": measured.mean_stiffness_percent,
    "force of largest damping": measured.force_of_largest_damping,
    "slider frequency": measured.slider_frequency,
    "slider critical amplitude": measured.slider_critical_amplitude,
    **{
        f"freevib error {name}": partial(measured.freevib_error, which=i)
        for i, name in enumerate(("frequency", "loss factor", "critical amplitude"))
    },
    "harmonic balance": measured.harmonic_balance,
    "damping trend 1B": partial(measured.damping_trend, mode="1B", least_force=0.0),
    "damping trend 2B": partial(measured.damping_trend, mode="2B", least_force=0.0),
    "damping trend 2B above 8 kN": partial(measured.damping_trend, mode="2B", least_force=8e3),
    **{
        f"slope over beam {mode} {side} 12 kN": partial(
            measured.slope_over_beam, mode=mode, above=side == "above"
        )
        for mode in ("1B", "2B")
        for side in ("below", "above")
    },
    **{
        f"Table {table} {part} percent": partial(
            measured.percent_of, table=table.replace(".", "_"), part=f"{part}_delta{unit}",
            whole=f"{part}{unit}",
        )
        for table, part, unit in (
            ("3.1", "frequency", "_Hz"), ("3.1", "loss_factor", ""),
            ("3.2", "frequency", "_Hz"), ("3.2", "loss_factor", ""),
            ("5.2", "kn", "_N_per_mm"), ("5.2", "kt", "_N_per_mm"),
        )
    },
    **{
        f"Table 2.2 {source}": lambda e, source=source: simulated.checked(e, f"Table 2.2, {source}")
        for source in ("experimental", "numerical coarse mesh", "numerical refined mesh")
    },
    "Table 4.1": lambda e: simulated.checked(e, "Table 4.1"),
    **{
        f"Table 4.2 {modes}": lambda e, modes=modes: simulated.table_4_2(e, *modes.split())
        for modes in ("X Y Z", "Rx", "Ry Rz", "1Fy 1Fz 2Fy 3Fy")
    },
    "Table 4.2 least slope": simulated.least_slope,
    "Table 4.3 bending 1": partial(simulated.normal_fixed, axis="Z", number=1),
    "Table 4.3 bending 2": partial(simulated.normal_fixed, axis="Z", number=2),
    "Table 4.3 lateral 1": partial(simulated.normal_fixed, axis="Y", number=1),
    "Table 4.4": simulated.table_4_4,
    "reduction residual": partial(simulated.largest_residual, check="reduced against full"),
    "nodes of a flank": simulated.nodes_of_a_flank,
    "Appendix B": simulated.appendix_b,
    **{f"searched {k}": partial(simulated.searched, name=k) for k in ("kn", "kt")},
    **{f"growth {k}": partial(simulated.growth, name=k) for k in ("kn", "kt")},
    **{f"std {k}": partial(simulated.std_at_table_5_2, name=k) for k in ("kn", "kt")},
    **{
        f"frequency misfit {mode}": partial(simulated.frequency_at_table_5_2, mode=mode)
        for mode in ("1B", "2B")
    },
    "correlation": simulated.correlation_at_table_5_2,
    "map curvature": simulated.curvature_of_the_map,
    "normal force": theoretical.normal_force,
    "pressure resultant": theoretical.pressure_resultant,
    "shear resultant": theoretical.shear_resultant,
    "stick over flat": theoretical.stick_over_flat,
    **{f"least step {k}": partial(theoretical.least_step, name=k) for k in ("kn", "kt")},
    **{
        f"published over theory {k}": partial(theoretical.published_over_theory, name=k)
        for k in ("kn", "kt")
    },
    **{
        f"least published over theory {k}": partial(theoretical.least_published_over_theory, name=k)
        for k in ("kn", "kt")
    },
    **{
        f"growth against published {k}": partial(theoretical.growth_against_published, name=k)
        for k in ("kn", "kt")
    },
    "dissipated": theoretical.dissipated_at_full_sliding,
    "approach of a flat": theoretical.approach_of_a_flat,
}  # fmt: skip
