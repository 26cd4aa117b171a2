"""Tables and figures of the page about the loop on the measured campaign."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import matplotlib.pyplot as plt
import numpy as np
from hati_reconciled import FOLDER, Document, stored
from kept_documents import cut_off
from matplotlib.colors import LogNorm
from virtual_lab import IMAGES, PAGES, save_figure, shorten_paths, table, write_results

from vgvt.data import InputError
from vgvt.files.atomically import replacing

PAGE, PARAMETERS = PAGES / "hati-reconciled.md", PAGES / "hati-reconciled-parameters.csv"
PARTS = {"train": "fitted", "held_out": "held out", "held_runs": "held-out runs", "held_channels": "held-out channels"}


def write() -> None:
    """All tables of the stages that are there, the parameters as CSV, and the figures; what was not run is said."""
    null = stored("null")
    if null is None:
        raise InputError("the page", "wants the stage null, which was not run", "run it first: name it as the STAGE")
    blocks = [_null(null), _bands()]
    for stage, title in (
        ("main", "The whole catalogue, model-form error 3 %"),
        ("first", "The same, stopped after one effect"),
        ("fine-floor", "The whole catalogue, model-form error 0.4 %"),
        ("without", "Control: the catalogue without what was named, or came nearest"),
        ("shuffled", "Control: labels permuted"),
    ):
        if stage == "first" and stored("main") is not None:
            continue  # a quicker look at what the whole one has
        found = stored(stage)
        said = [f"**{title}**\n\nNot run to its end."] if found is None else [_verdict(found, title), _rounds(found)]
        blocks += said if found is None or stage not in ("main", "first") else [*said, _places(found)]
    blocks += [_parameters(null, stored("main") or stored("first")), _wrong(), _splits()]
    write_results(PAGE, "\n\n".join(b for b in blocks if b))
    _overlays(stored("main") or stored("first"))
    _maps()


def _null(d: Document) -> str:
    rows = []
    for label, name in (("stated", "as stated"), ("calibrated", "calibrated")):
        for key, part in PARTS.items():
            m = d[label]["errors"][key]
            rows.append((f"{name}, {part}", *_errors(m)))
    modes = []
    for label, name in (("stated", "as stated"), ("calibrated", "calibrated")):
        pairs = zip(d[label]["frequency_hz"], d[label]["damping_ratio"], strict=True)
        modes.append(f"{name} " + ", ".join(f"{f:.2f} Hz ({100 * z:.1f} %)" for f, z in pairs))
    reasons = "\n".join(f"- {r}" for r in d["calibrated"]["reasons"])
    wall, own, load = d["calibration_s"]
    state = "converged" if d["converged"] else "did not converge within its iterations"
    return (
        f"**The nominal model, no effect added**\n\n{table(HEAD, rows)}\n\n"
        f"Modes of the model within the band (damping): {'; '.join(modes)}.\n\n"
        f"Is what the calibrated model leaves noise?\n\n{reasons}\n"
        f"- neighbouring lines of it are correlated by {d['calibrated']['lag_one']:.2f}\n\n"
        f"The calibration {state}; reading, deriving and calibrating took {own:.0f} s of processor time "
        f"({wall:.0f} s on two cores under a load of {load:.0f}).\n\n{_places(d)}"
    )


HEAD = ("channels", "χ² per degree of freedom", "NRMSE fit, % (median)", "mean error, dB", "FRAC (median)")


def _errors(m: dict[str, float]) -> tuple[str, ...]:
    return (f"{m['chi2_per_dof']:.1f}", f"{m['nrmse_percent']:.1f}", f"{m['mean_abs_db']:.2f}", f"{m['frac']:.3f}")


def _verdict(d: Document, title: str) -> str:
    reasons = "\n".join(f"- {r}" for r in d["reasons"])
    left = "\n".join(f"- {r}" for r in d["unexplained"]) or "- nothing"
    rows = []
    for key, name in PARTS.items():
        for label in ("before", "after"):
            m = d[label][key]
            if m is not None:
                rows.append((f"{name}, {label}", *_errors(m)))
        led = (d.get("with_leads") or {}).get(key)
        if led is not None:
            rows.append((f"{name}, with the leads", *_errors(led)))
    state = d["converged"]
    facts = (
        f"{d['wall_s']:.0f} s ({d['processor_s']:.0f} s of processor time, load {d['load']:.0f} on two cores); "
        f"calibration {_word(state['before'])} before, {_word(state['after'])} after; "
        f"thresholds: {d['thresholds']['provenance']}."
    )
    return (
        f"**{title}: {d['verdict'].replace('_', ' ')}**\n\n{reasons}\n\nWhat stays unexplained:\n\n{left}\n\n"
        f"{table(HEAD, rows)}\n\n{facts}"
    )


def _word(converged: bool) -> str:
    return "converged" if converged else "stopped at its limit of iterations"


def _arrays(stage: str) -> Any:
    path = FOLDER / f"{stage}.npz"
    try:
        return np.load(path)
    except (OSError, ValueError, EOFError, BadZipFile) as error:
        raise cut_off(path, f"remove {stage}.json beside it and run the stage again: {stage}") from error


def _bands() -> str:
    with _arrays("null") as a:
        edges, rows = a["bands_hz"], []
        train = a["train"]
        for k in range(edges.size - 1):
            cells = [f"{a[t][keep, k].mean():.0f}" for keep in (train, ~train) for t in ("table_before", "table_after")]
            rows.append((f"{edges[k]:.1f}–{edges[k + 1]:.1f}", *cells))
    head = ("Hz", "fitted, as stated", "fitted, calibrated", "held out, as stated", "held out, calibrated")
    return "**Where the residual lives: χ² per degree of freedom by band, no effect added**\n\n" + table(head, rows)


def _value(row: dict[str, Any]) -> str:
    if "calibrated" in row:
        return f"{row['calibrated']:.4g} {row['unit']} (stated {row['stated']:.4g})"
    return f"× {row['factor']:.3f}" if "factor" in row else f"{row['shift']:+.2f}"


def _parameters(null: Document, after: Document | None) -> str:
    later = {} if after is None else {r["name"]: r for r in after["posterior"]}
    with replacing(PARAMETERS) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            ("name", "score", "std", "factor_or_shift", "score_after", "std_after", "factor_or_shift_after")
        )
        for r in null["posterior"]:
            cells = [r["score"], r["std_score"], r.get("factor", r.get("shift"))]
            if (b := later.get(r["name"])) is not None:
                cells += [b["score"], b["std_score"], b.get("factor", b.get("shift"))]
            writer.writerow((r["name"], *(f"{c:.5g}" for c in cells)))
    # How coarse a chain the records come from is no tolerance: an aircraft has no cells.
    stated = [r for r in null["posterior"] if r["name"] != "cells"]
    far = sorted((r for r in stated if abs(r["score"]) > 3), key=lambda r: -abs(r["score"]))
    rows = []
    for r in far:
        b = later.get(r["name"])
        rows.append((r["what"], _score(r), _value(r), *(("–", "–") if b is None else (_score(b), _value(b)))))
    head = ("quantity", "score", "calibrated", "score with what was named, or came nearest", "calibrated with it")
    text = (
        f"{len(far)} of {len(stated)} calibrated quantities leave three standard deviations of their "
        "tolerance before any effect is added; here they are, all are in "
        "[`hati-reconciled-parameters.csv`](hati-reconciled-parameters.csv):"
    )
    return f"**Calibrated quantities**\n\n{text}\n\n{table(head, rows)}"


def _score(r: dict[str, Any]) -> str:
    return f"{r['score']:+.1f} ± {r['std_score']:.1f}"


def _rounds(d: Document) -> str:
    blocks = []
    rounds = [(f"Round {k + 1}", r) for k, r in enumerate(d["rounds"])]
    if not rounds or d["last_rivals"] != d["rounds"][-1]:
        rounds.append(("What came next" if rounds else "Candidates", d["last_rivals"]))
    for title, rivals in rounds:
        rows = []
        for r in rivals[:8]:
            values = ", ".join(f"{k} {v[0]:.3g} ± {v[1]:.1g} {v[2]}".rstrip() for k, v in r["parameters"].items())
            held = "–" if r["held_out"] is None else f"{r['held_out']:.2f}"
            rows.append((r["effect"], values, f"{r['gain_nats']:.0f}", f"{r['raw_nats']:.0f}", held))
        head = (f"{title}: effect", "fitted parameters", "nats, tempered", "nats, raw", "held-out χ² per dof")
        blocks.append(table(head, rows) if rows else f"{title}: none was worth a fit.")
    return "\n\n".join(blocks)


def _places(d: Document) -> str:
    rows = [(p["place"], f"{100 * p['explained']:.0f} %", p["type"] or "–") for p in d["localisation"]]
    return "**Where a free force would explain most of what is left**\n\n" + table(
        ("place", "share of the residual", "looks like"), rows
    )


def _wrong() -> str:
    found = stored("wrong-place")
    if found is None:
        return "**Control: wrong place**\n\nNot run."
    rows = []
    for name, places in found.items():
        if "place" in places:
            rows.append((name, "has no place", "", "", ""))
            continue
        for label, r in places.items():
            rows.append(
                (
                    name,
                    label,
                    f"({r['x_m']:.3f}, {r['y_m']:.3f})",
                    f"{r['raw_nats']:.0f}",
                    f"{r['errors']['held_out']['chi2_per_dof']:.2f}",
                )
            )
    head = ("effect", "offered", "x, y in m", "nats, raw", "held-out χ² per dof")
    return "**Control: wrong place**\n\n" + (table(head, rows) if rows else "Nothing was named.")


def _splits() -> str:
    found = stored("splits")
    if found is None:
        return "**Six more hold-outs**\n\nNot run."
    rows = []
    for what, r in found.items():
        cells = [what]
        for label in ("before", "after"):
            for part in ("train", "held_out"):
                m = r.get(label, {}).get(part)
                cells.append("–" if m is None else f"{m['chi2_per_dof']:.1f} / {m['nrmse_percent']:.0f} %")
        rows.append(cells)
    head = ("fitted", "fitted, before", "judged, before", "fitted, with the leads", "judged, with the leads")
    return "**Six more hold-outs: χ² per degree of freedom / NRMSE fit, both ways**\n\n" + table(head, rows)


def _overlays(named: Document | None) -> None:
    stage = "main" if stored("main") is not None else "first"
    with _arrays("null") as a:
        f, held = a["frequency_hz"], np.flatnonzero(~a["train"])
        lines = [("before", "nominal as stated", "tab:orange"), ("after", "calibrated, no effect added", "tab:red")]
        curves = [(a[key], label, colour) for key, label, colour in lines]
        if named is not None and (named["effects"] or named["leads"]):
            with _arrays(stage) as b:
                label = "with what was named" if named["effects"] else "with what comes nearest"
                curves.append((b["after"], label, "tab:blue"))
        figure, axes = plt.subplots(3, 2, figsize=(8.2, 7.6), sharex=True, layout="constrained")
        for ax, i in zip(axes.flat, held, strict=False):
            size = np.abs(a["values"][i])
            ax.semilogy(f, size, ".", color="0.45", markersize=2, label="measured", rasterized=True)
            for values, label, colour in curves:
                ax.semilogy(f, np.abs(values[i]), color=colour, linewidth=0.9, label=label)
            ax.set_title(f"point {a['node'][i]}, run {a['run'][i]}", fontsize=9)
            low, high = np.percentile(size, [1, 99.8])
            ax.set_ylim(low / 5, 5 * high)
            ax.grid(alpha=0.3)
        figure.supylabel("|A/F| in (m/s²)/N, held-out channels", fontsize=9)
        for ax in axes[-1]:
            ax.set_xlabel("frequency in Hz")
        figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
        _save(figure, "study-hati-reconciled-overlays")


def _maps() -> None:
    with _arrays("null") as a:
        order = np.argsort(a["node"])
        figure, axes = plt.subplots(1, 2, figsize=(8.2, 4.4), sharey=True, layout="constrained")
        for ax, key, title in zip(
            axes, ("table_before", "table_after"), ("as stated", "calibrated, no effect added"), strict=True
        ):
            shown = ax.imshow(
                a[key][order], aspect="auto", norm=LogNorm(1, 10000), cmap="viridis", interpolation="nearest"
            )
            labels = [f"{n}{'' if a['train'][i] else ' *'}" for i, n in zip(order, a["node"][order], strict=True)]
            ax.set_yticks(range(len(labels)), labels, fontsize=7)
            edges = a["bands_hz"]
            ax.set_xticks(np.arange(edges.size) - 0.5, [f"{e:.0f}" for e in edges], fontsize=7)
            ax.set(title=title, xlabel="band, Hz")
        axes[0].set_ylabel("point (* held out)")
        figure.colorbar(shown, ax=axes, label="χ² per degree of freedom")
        _save(figure, "study-hati-reconciled-residual")


def _save(figure: Any, name: str) -> None:
    path: Path = IMAGES / f"{name}.svg"
    save_figure(figure, path, dpi=130)
    save_figure(figure, FOLDER / f"{name}.png", dpi=110)
    plt.close(figure)
    shorten_paths(path)
