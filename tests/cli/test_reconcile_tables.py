"""Tables of ``vgvt reconcile`` in a terminal: what tells rows apart stays, and no heading says the opposite."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from rich.console import Console

from vgvt.cli.reconcile_tables import error_table, power_table
from vgvt.effects.parameter import parameters_of
from vgvt.effects.registry import available_effects
from vgvt.reconcile.next_test.power_rows import invisible
from vgvt.view.power_account import PowerRow

_ALIKE = (("drive-point-offset", 0.99), ("stinger-moment", 0.97), ("sensor-position-error", 0.91))


def lines_of(table: object, width: int) -> list[str]:
    console = Console(width=width, no_color=True)
    with console.capture() as capture:
        console.print(table)
    return capture.get().splitlines()


def row(effect: str, parameter: str, unit: str) -> PowerRow:
    return PowerRow(effect, effect, parameter, unit, 0.00123, 0.00456, -0.02, 0.02, _ALIKE)


@pytest.mark.parametrize("width", [80, 100, 120, 140])
def test_parameters_of_one_effect_can_be_told_apart(width: int) -> None:
    names = ("compliance_m_per_n", "loss_factor", "frequency_hz")
    longest = row("amplitude-dependent-damping", "growth_per_rtkg_m", "1/(kg^0.5 m)")
    found = lines_of(power_table((*(row("mount-compliance", name, "m/N") for name in names), longest)), width)
    text = "\n".join(found)
    for name in (*names, "growth_per_rtkg_m"):
        assert sum(name in line for line in found) == 1
    assert max(map(len, found)) <= width
    assert text.count("0.0012") == text.count("0.0046") == 4
    assert text.count("m/N") == (3 if width >= 100 else 0)


def test_what_is_alike_goes_first_and_then_what_is_plausible() -> None:
    table = power_table([row("hook-offset", name, "m") for name in ("dx_m", "dy_m")])
    heads = {width: "".join(lines_of(table, width)[1:5]) for width in (120, 100, 60)}
    assert ["hard to tell from" in heads[w] for w in (120, 100, 60)] == [True, False, False]
    assert ["plausible" in heads[w] for w in (120, 100, 60)] == [True, True, False]
    assert all("parameter" in head and "unit" in head for head in heads.values())


@pytest.mark.parametrize("width", [80, 100, 120])
def test_the_whole_catalogue_loses_no_size_and_no_answer(width: int) -> None:
    rows = [
        row(name, p.name, p.unit)
        for name, cls in available_effects().items()
        for p in parameters_of(cls)
        if p.neutral is not None
    ]
    found = "\n".join(lines_of(power_table(rows), width))
    for cell in ("0.0012", "0.0046", " yes "):
        assert found.count(cell) == len(rows)


def test_the_fit_is_not_headed_as_an_error() -> None:
    merit = {"chi2_per_dof": 1.0, "nrmse_percent": 99.34, "mean_abs_db": 0.1}
    state = {"train": merit, "held_out": merit}
    found = "\n".join(lines_of(error_table({"effects": (), "before": state}), 120))
    assert "NRMSE fit %" in found and "99.34" in found
    assert "error" not in found


def test_what_the_file_does_when_simulated_stands_beside_the_fit() -> None:
    merit = {"chi2_per_dof": 1.0, "nrmse_percent": 99.34, "mean_abs_db": 0.1}
    again = {"chi2_per_dof": 1.57, "nrmse_percent": 88.25, "mean_abs_db": 0.4}
    state = {"train": merit, "held_out": merit, "held_runs": None}
    made = {"train": again, "held_out": again, "held_runs": None, "apart": 0.02, "remark": "It is 2 % from the fit"}
    found = "\n".join(lines_of(error_table({"effects": (), "before": state, "resimulated": made}), 120))
    assert found.count("simulated again") == found.count("88.25") == found.count("1.57") == 2
    assert "It is 2 % from the fit" in found
    skipped = dict.fromkeys(made) | {"remark": "reconciled.toml was not simulated: no reason"}
    found = "\n".join(lines_of(error_table({"effects": (), "before": state, "resimulated": skipped}), 120))
    assert "simulated again" not in found and "was not simulated: no reason" in found


@pytest.mark.parametrize("width", [60, 80, 120])
def test_every_model_has_a_line_and_every_set_of_data_is_named_once(width: int) -> None:
    merit = {"chi2_per_dof": 1.0, "nrmse_percent": 99.34, "mean_abs_db": 0.1}
    state = {"train": merit, "held_out": merit, "held_runs": merit, "held_channels": merit}
    document = {"effects": ("one",), "before": state, "after": state, "resimulated": state | {"remark": ""}}
    found = lines_of(error_table(document), width)
    for model in ("calibrated", "with what was named", "simulated again"):
        assert sum(model in line for line in found) == 4
    for data in ("fitted", "held out", "whole runs", "single channels"):
        assert sum(line.strip().startswith(data) for line in found) == 1
    assert max(map(len, found[1:])) <= width


def test_what_is_all_that_is_held_out_is_told_once() -> None:
    merit = {"chi2_per_dof": 1.0, "nrmse_percent": 99.34, "mean_abs_db": 0.1}
    state = {"train": merit, "held_out": merit, "held_runs": None, "held_channels": merit}
    found = "\n".join(lines_of(error_table({"effects": (), "before": state}), 120))
    assert "held out" in found and "single channels" not in found


def spread(smallest: float, named: float, worst: float, reason: str = "") -> PowerRow:
    return PowerRow(
        "local-absorber", "", "mass_kg", "kg", smallest, named, 0.02, 0.3, variants=3, worst=worst, reason=reason
    )


def test_where_it_shows_worst_stands_beside_where_it_shows_best() -> None:
    rows = [spread(6e-5, 1.6e-4, 7.8e-3), spread(6e-5, 1.6e-4, math.inf)]
    found = "\n".join(lines_of(power_table(rows), 120))
    assert found.count("6e-05") == found.count("0.00016") == 2
    assert found.count("0.0078") == found.count("never") == 1
    for words in ("where it shows best", "at worst", "place, side or channel"):
        assert words in found
    alone = "\n".join(lines_of(power_table([row("hook-offset", "aft_m", "m")]), 120))
    assert "worst" not in alone


@pytest.mark.parametrize("width", [80, 120])
def test_a_size_that_is_not_known_is_no_answer(width: int) -> None:
    rows = [
        spread(math.nan, math.nan, math.nan, "by level: not foretold"),
        spread(math.nan, math.nan, math.nan, "not known"),
    ]
    found = " ".join(lines_of(power_table(rows), width))
    assert "nan" not in found
    assert found.count(" unknown") == 2
    assert found.count("not known") == 1
    assert "0 of 2 show" in found
    assert "by level: not foretold" in " ".join(found.split())


def test_what_is_not_known_is_not_called_invisible() -> None:
    """Nor is an effect of which one parameter shows."""
    known = PowerRow("mass", "mass", "mass_kg", "kg", 0.01, 0.02, 0.001, 0.1)
    rows = [
        known,
        replace(known, parameter="x_m", smallest=math.inf),
        replace(known, effect="hum", smallest=math.inf),
        replace(known, effect="tilt", smallest=0.2),
        replace(known, effect="play", smallest=math.nan),
    ]
    assert invisible(rows) == ["hum", "tilt"]
