"""Tables and figures of the page about the loop on the measured campaign."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from hati_reconciled import FOLDER, Document, stored
from matplotlib.colors import LogNorm
from virtual_lab import IMAGES, PAGES, table, write_results

PAGE, PARAMETERS = PAGES / "hati-reconciled.md", PAGES / "hati-reconciled-parameters.csv"
PARTS = {"train": "fitted", "held_out": "held out", "held_runs": "held-out runs", "held_channels": "held-out channels"}
BANDS = "blocks of lines"


def write() -> None:
    """All tables of the stages that are there, the parameters as CSV, and the figures."""
    stage = "main" if stored("main") is not None else "first"
    main = stored(stage)
    if main is None:
        raise SystemExit("the stage 'main' comes first")
    most = "" if stage == "main" else ", stopped after one effect"
    title = f"The whole catalogue, model-form error 3 %{most}"
    blocks = [_verdict(main, title), _bands(stage), _parameters(main), _rounds(main), _places(main)]
    for other, title in (
        ("fine-floor", "The whole catalogue, model-form error 0.4 %"),
        ("without", "Control: the catalogue without what was named"),
        ("shuffled", "Control: labels permuted"),
    ):
        found = stored(other)
        blocks.append(f"**{title}**\n\nNot run." if found is None else _verdict(found, title) + "\n\n" + _rounds(found))
    blocks += [_wrong(), _splits()]
    write_results(PAGE, "\n\n".join(b for b in blocks if b))
    _overlays(stage)
    _maps(stage)


def _verdict(d: Document, title: str) -> str:
    reasons = "\n".join(f"- {r}" for r in d["reasons"])
    left = "\n".join(f"- {r}" for r in d["unexplained"]) or "- nothing"
    rows = []
    for key, name in PARTS.items():
        for label in ("before", "after"):
            m = d[label][key]
            if m is not None:
                rows.append((f"{name}, {label}", f"{m['chi2_per_dof']:.1f}", f"{m['nrmse_percent']:.1f}", f"{m['mean_abs_db']:.2f}", f"{m['frac']:.3f}"))
    head = ("channels", "χ² per degree of freedom", "NRMSE fit, % (median)", "mean error, dB", "FRAC (median)")
    state = d["converged"]
    facts = (
        f"{d['wall_s']:.0f} s ({d['processor_s']:.0f} s of processor time, load {d['load']:.0f} on two cores); "
        f"calibration {_word(state['before'])} before, {_word(state['after'])} after; thresholds: {d['thresholds']['provenance']}."
    )
    return (
        f"**{title}: {d['verdict'].replace('_', ' ')}**\n\n{reasons}\n\nWhat stays unexplained:\n\n{left}\n\n"
        f"{table(head, rows)}\n\n{facts}"
    )


def _word(converged: bool) -> str:
    return "converged" if converged else "stopped at its limit of iterations"


def _bands(stage: str) -> str:
    with np.load(FOLDER / f"{stage}.npz") as a:
        edges, rows = a["bands_hz"], []
        train = a["train"]
        for k in range(edges.size - 1):
            cells = [f"{a[t][keep, k].mean():.0f}" for keep in (train, ~train) for t in ("table_before", "table_after")]
            rows.append((f"{edges[k]:.1f}–{edges[k + 1]:.1f}", *cells))
    head = ("Hz", "fitted, before", "fitted, after", "held out, before", "held out, after")
    return "**Where the residual lives: χ² per degree of freedom by band, model-form error 3 %**\n\n" + table(head, rows)


def _value(row: dict[str, Any]) -> str:
    if "calibrated" in row:
        return f"{row['calibrated']:.4g} {row['unit']} (stated {row['stated']:.4g})"
    return f"× {row['factor']:.3f}" if "factor" in row else f"{1e3 * row['shift']:+.1f} mm"


def _parameters(d: Document) -> str:
    before = {r["name"]: r for r in d["posterior_before"]}
    with PARAMETERS.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(("name", "score_before", "std_before", "score_after", "std_after", "factor_or_shift_before", "factor_or_shift_after"))
        for r in d["posterior"]:
            b = before[r["name"]]
            cells = (b["score"], b["std_score"], r["score"], r["std_score"], b.get("factor", b.get("shift")), r.get("factor", r.get("shift")))
            writer.writerow((r["name"], *(f"{c:.5g}" for c in cells)))
    far = [r for r in d["posterior"] if not r["name"].startswith("gain run") and max(abs(r["score"]), abs(before[r["name"]]["score"])) > 3]
    far.sort(key=lambda r: -abs(before[r["name"]]["score"]))
    rows = [(r["what"], _score(before[r["name"]]), _value(before[r["name"]]), _score(r), _value(r)) for r in far]
    count = sum(abs(r["score"]) > 3 for r in d["posterior_before"])
    head = ("quantity", "score before", "calibrated before", "score after", "calibrated after")
    text = (
        f"{count} of {len(before)} calibrated quantities leave three standard deviations of their tolerance before, "
        f"{sum(abs(r['score']) > 3 for r in d['posterior'])} after. Those (channel gains of single runs left out; all are in "
        "[`hati-reconciled-parameters.csv`](hati-reconciled-parameters.csv)); scores in standard deviations of the tolerance:"
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
    return "**Where a free force would explain most of what is left**\n\n" + table(("place", "share of the residual", "looks like"), rows)


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
            rows.append((name, label, f"({r['x_m']:.3f}, {r['y_m']:.3f})", f"{r['raw_nats']:.0f}", f"{r['errors']['held_out']['chi2_per_dof']:.2f}"))
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
    head = ("fitted", "fitted, before", "judged, before", "fitted, after", "judged, after")
    return "**Six more hold-outs: χ² per degree of freedom / NRMSE fit, both ways**\n\n" + table(head, rows)


def _overlays(stage: str) -> None:
    with np.load(FOLDER / f"{stage}.npz") as a:
        f, held = a["frequency_hz"], np.flatnonzero(~a["train"])
        figure, axes = plt.subplots(3, 2, figsize=(8.2, 7.6), sharex=True, layout="constrained")
        for k, i in zip(axes.flat, held, strict=False):
            k.semilogy(f, np.abs(a["values"][i]), ".", color="0.45", markersize=2, label="measured")
            k.semilogy(f, np.abs(a["before"][i]), color="tab:red", linewidth=0.9, label="calibrated, no effect added")
            k.semilogy(f, np.abs(a["after"][i]), color="tab:blue", linewidth=0.9, label="with what was named")
            k.set_title(f"point {a['node'][i]}, run {a['run'][i]}", fontsize=9)
            low, high = np.percentile(np.abs(a["values"][i]), [1, 99.8])
            k.set_ylim(low / 3, 3 * high)
            k.grid(alpha=0.3)
        figure.supylabel("|A/F| in (m/s²)/N, held-out channels", fontsize=9)
        figure.supxlabel("frequency in Hz", fontsize=9)
        figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
        _save(figure, "study-hati-reconciled-overlays")


def _maps(stage: str) -> None:
    with np.load(FOLDER / f"{stage}.npz") as a:
        order = np.argsort(a["node"])
        figure, axes = plt.subplots(1, 2, figsize=(8.2, 4.4), sharey=True, layout="constrained")
        for ax, key, title in zip(axes, ("table_before", "table_after"), ("before", "after"), strict=True):
            shown = ax.imshow(a[key][order], aspect="auto", norm=LogNorm(1, 1000), cmap="viridis", interpolation="nearest")
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
    figure.savefig(path, metadata={"Date": None})
    figure.savefig(FOLDER / f"{name}.png", dpi=110)
    plt.close(figure)
    text = path.read_text(encoding="utf-8")
    path.write_text(re.sub(r"(\d+\.\d{2})\d+", r"\1", text), encoding="utf-8")
