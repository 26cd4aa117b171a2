"""Tables and figure of the page about who finds what in the measured campaign."""

from __future__ import annotations

import csv

import matplotlib.pyplot as plt
import numpy as np
from hati_identified import COPY, FOLDER, RUNS, Finding, stored, timed
from virtual_lab import IMAGES, PAGES, save_figure, shorten_paths, table, write_results

from vgvt.files import open_campaign
from vgvt.files.atomically import replacing
from vgvt.signals import estimate_frf

PAGE, TABLE = PAGES / "hati-identified.md", PAGES / "hati-identified.csv"
GAP = 0.012
"""Claims further apart than this part of their frequency start a new row; it orders the table and decides nothing."""
PAPER = (
    (7.95, "7.95 / 7.96"),
    (13.83, "– / 13.83"),
    (15.96, "15.96 / 15.97"),
    (19.07, "19.22 / 19.07"),
    (31.9, "32.0 / 31.9"),
)
"""Table 3 of the paper: frequency to look near, and its columns quadrature / CFDD as printed."""
LOG = (7.797, 19.058, 23.819, 31.784)


def write(methods: list[str]) -> None:
    """Page, CSV of every claim, and figure."""
    merged = {m: f for m in methods if (f := stored(m, "all")) is not None}
    alone = {m: [f for r in RUNS if (f := stored(m, f"run-{r}")) is not None] for m in methods}
    _write_csv([*merged.values(), *(f for fs in alone.values() for f in fs)])
    rows = groups([f for found in merged.values() for f in found.frequency_hz])
    blocks = [_outcomes(merged, alone), _who(merged, rows), _runs(alone, rows), _claims(merged, alone), _times(methods)]
    write_results(PAGE, "\n\n".join(blocks))
    picture(merged, alone)


def groups(frequency_hz: list[float]) -> list[tuple[float, float]]:
    """Intervals (lowest, highest) of claims that lie together."""
    found: list[list[float]] = []
    for f in sorted(frequency_hz):
        if found and f / found[-1][-1] - 1 < GAP:
            found[-1].append(f)
        else:
            found.append([f])
    return [(g[0], g[-1]) for g in found]


def _write_csv(findings: list[Finding]) -> None:
    with replacing(TABLE) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            ("method", "runs", "frequency_hz", "frequency_std_hz", "damping_ratio", "damping_ratio_std", "flags")
        )
        for f in findings:
            for k, hertz in enumerate(f.frequency_hz):
                values = (hertz, f.frequency_std_hz[k], f.damping_ratio[k], f.damping_ratio_std[k])
                writer.writerow(
                    (f.method, f.part, *("" if v is None else f"{v:.6g}" for v in values), "; ".join(f.flags[k]))
                )


def _claim(f: Finding, k: int) -> str:
    """Frequency with its stated standard deviation in the last digits' unit, and damping in per cent."""
    sd = f.frequency_std_hz[k]
    hertz = f"{f.frequency_hz[k]:.3f}" if sd is None else f"{f.frequency_hz[k]:.3f} ± {sd:.2g}"
    zsd = f.damping_ratio_std[k]
    ratio = f"{100 * f.damping_ratio[k]:.2f}" if zsd is None else f"{100 * f.damping_ratio[k]:.2f} ± {100 * zsd:.2g}"
    return f"{hertz} ({ratio})"


def _inside(f: Finding, low: float, high: float) -> list[int]:
    return [k for k, v in enumerate(f.frequency_hz) if low - 1e-9 <= v <= high + 1e-9]


def _outcomes(merged: dict[str, Finding], alone: dict[str, list[Finding]]) -> str:
    rows = []
    for m, f in merged.items():
        counts = [len(g.frequency_hz) for g in alone[m]]
        failed = [g.reason for g in alone[m] if g.reason]
        runs = f"{min(counts)}–{max(counts)} modes in {len(counts)} runs" if counts else "not run"
        said = f.reason or (f.outcome.replace("_", " ") if not f.frequency_hz else f"{len(f.frequency_hz)} modes")
        rows.append((f"`{m}`", said, runs + (f"; {len(failed)} failed: {failed[0]}" if failed else "")))
    return "**What came of it**\n\n" + table(("method", "all runs together", "each run alone"), rows)


def _who(merged: dict[str, Finding], rows: list[tuple[float, float]]) -> str:
    lines = []
    for low, high in rows:
        claims = [f"`{m}` {_claim(f, k)}" for m, f in merged.items() for k in _inside(f, low, high)]
        finders = sum(bool(_inside(f, low, high)) for f in merged.values())
        lines.append(
            (f"{low:.2f}" if high - low < 0.005 else f"{low:.2f}–{high:.2f}", str(finders), "<br>".join(claims))
        )
    head = ("Hz", "methods", "claims: Hz ± stated standard deviation (damping in %)")
    return f"**All runs together: {len(merged)} methods**\n\n" + table(head, lines)


def _runs(alone: dict[str, list[Finding]], rows: list[tuple[float, float]]) -> str:
    lines = []
    for low, high in rows:
        cells = []
        for found in alone.values():
            wide = [[f.frequency_hz[k] for k in _inside(f, low * (1 - GAP / 2), high * (1 + GAP / 2))] for f in found]
            values = [v for claims in wide for v in claims]
            hits = sum(bool(claims) for claims in wide)
            cells.append("–" if not values else f"{hits}/{len(found)}: {min(values):.2f}–{max(values):.2f}")
        lines.append((f"{low:.2f}–{high:.2f}", *cells))
    head = ("Hz", *(f"`{m}`" for m in alone))
    return "**Run by run: in how many of the runs a method claims a mode there, and from where to where**\n\n" + table(
        head, lines
    )


def _claims(merged: dict[str, Finding], alone: dict[str, list[Finding]]) -> str:
    lines = []
    for near, printed in PAPER:
        with_it = [m for m, f in merged.items() if any(abs(v / near - 1) < 0.02 for v in f.frequency_hz)]
        nearest = [min(f.frequency_hz, key=lambda v: abs(v - near)) for f in merged.values() if f.frequency_hz]
        off = sorted(100 * (v / near - 1) for v in nearest)
        in_runs = sum(any(abs(v / near - 1) < 0.02 for v in f.frequency_hz) for fs in alone.values() for f in fs)
        total = sum(len(fs) for fs in alone.values())
        lines.append((
            printed, f"{len(with_it)} of {len(merged)}: {', '.join(with_it) or 'none'}", f"{in_runs} of {total}",
            f"{off[0]:+.2f} to {off[-1]:+.2f} %" if off else "–",
        ))  # fmt: skip
    head = (
        "Table 3 (quadrature / CFDD), Hz",
        "methods with a claim within 2 %, all runs",
        "method × run with one",
        "nearest claim of every method",
    )
    return "**The paper's claims**\n\n" + table(head, lines)


def _times(methods: list[str]) -> str:
    lines = []
    for m in methods:
        if not (FOLDER / f"timed-{m}.json").is_file():
            continue
        values = timed(m)
        assert values is not None
        modes, wall, own, idle, peak, load = values
        lines.append(
            (f"`{m}`", f"{modes:.0f}", f"{wall:.2f}", f"{own:.2f}", f"{peak - idle:.0f}", f"{peak:.0f}", f"{load:.1f}")
        )
    head = (
        "method",
        "modes",
        "wall, s",
        "processor, s",
        "peak growth while identifying, MiB",
        "peak of the process, MiB",
        "load",
    )
    return "**Time and memory on the copy at 200 Hz (20 channels, ten runs), one thread**\n\n" + table(head, lines)


def picture(merged: dict[str, Finding], alone: dict[str, list[Finding]]) -> None:
    """The sigma plot above the modes that every method claims."""
    frf = estimate_frf(open_campaign(COPY), band_hz=(1.5, 34.5))
    sigma = np.sqrt(np.sum(np.abs(frf.values[:, 0]) ** 2, axis=0))
    figure, (top, low) = plt.subplots(
        2, 1, figsize=(8.2, 6.6), sharex=True, layout="constrained", height_ratios=(1, 1.1)
    )
    top.semilogy(frf.frequency_hz, sigma, color="0.25", linewidth=0.6)
    top.set_ylabel("root of the sum of |A/F|²\nin (m/s²)/N")
    names = sorted(merged, reverse=True)
    for row, method in enumerate(names):
        runs = [v for f in alone[method] for v in f.frequency_hz]
        low.plot(runs, [row - 0.2] * len(runs), "|", color="0.6", markersize=6, markeredgewidth=0.6)
        low.plot(
            merged[method].frequency_hz, [row] * len(merged[method].frequency_hz), "o", color="tab:blue", markersize=4
        )
    low.set_yticks(range(len(names)), names)
    low.set(xlabel="frequency in Hz", xlim=(1.5, 34.5), ylim=(-0.7, len(names) - 0.4))
    for axes in (top, low):
        for f, _ in PAPER:
            axes.axvline(f, color="tab:red", linewidth=0.8, linestyle="--", zorder=0)
        axes.grid(alpha=0.3)
    low.plot([], [], "o", color="tab:blue", markersize=4, label="all runs together")
    low.plot([], [], "|", color="0.6", markersize=6, label="one run alone")
    low.plot([], [], "--", color="tab:red", linewidth=0.8, label="the paper's Table 3 (CFDD)")
    figure.legend(*low.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    save_figure(figure, IMAGES / "study-hati-identified.svg")
    save_figure(figure, FOLDER / "look.png", dpi=110)
    plt.close(figure)
    shorten_paths(IMAGES / "study-hati-identified.svg")
