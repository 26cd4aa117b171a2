"""``vgvt show``: what a scenario looks like, weighs and how it vibrates."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vgvt.cli.boundary import CommandError
from vgvt.cli.console import log, show
from vgvt.cli.document import write_document
from vgvt.cli.hanging import hanging, without_sign
from vgvt.cli.new_folders import none_left_empty
from vgvt.cli.options import JsonOption, ScenarioArgument
from vgvt.cli.rendering import advice, load_opengl

if TYPE_CHECKING:
    from vgvt.data import ModalModel, Truth
    from vgvt.scenario.model import Scenario

OutOption = Annotated[
    Path | None,
    typer.Option("--out", metavar="FOLDER|FILE.png", help="Where the picture goes; SCENARIO.png here when left out."),
]
ModeOption = Annotated[
    int | None, typer.Option("--mode", min=1, metavar="N", help="Animate mode N as tested, as WebP beside the picture.")
]
WidthOption = Annotated[int, typer.Option(min=64, max=4096, help="Width of the picture in pixels.")]
HeightOption = Annotated[int, typer.Option(min=64, max=4096, help="Height of the picture in pixels.")]
NoPictureOption = Annotated[bool, typer.Option("--no-picture", help="Print only; needs no OpenGL.")]


def show_scenario(
    scenario: ScenarioArgument,
    out: OutOption = None,
    mode: ModeOption = None,
    width: WidthOption = 1280,
    height: HeightOption = 800,
    no_picture: NoPictureOption = False,
    as_json: JsonOption = False,
) -> int:
    """Show a scenario's rig: a picture, mass properties, modes and the rig's own resonances."""
    from vgvt.cli.described import described_scenario, say_what_is_not_as_described
    from vgvt.data import InputError

    if no_picture and (out is not None or mode is not None):
        raise InputError("--no-picture", "leaves nothing for --out and --mode to do", "leave out one or the other")
    loaded = described_scenario(scenario)
    picture = None if no_picture else _picture_path(out, loaded.name)
    if picture is not None:
        load_opengl()
    from vgvt.simulation import truth_of
    from vgvt.simulation.attitude import attitudes_deg

    say_what_is_not_as_described(loaded)
    truth, hangs_deg = truth_of(loaded), attitudes_deg(loaded)
    _check_mode(truth, mode)
    animation = _render(loaded, picture, mode, width, height) if picture is not None else None
    if as_json:
        write_document(_document(loaded, truth, picture, animation) | {"hangs_at_roll_pitch_deg": hangs_deg})
    else:
        _print(loaded, truth, hangs_deg, picture, animation)
    return 0


def _picture_path(out: Path | None, name: str) -> Path:
    from vgvt.data import InputError

    if out is None:
        return Path(f"{name}.png")
    if out.suffix.lower() == ".png" and not out.is_dir():
        return out
    if out.suffix and not out.is_dir():
        raise InputError("--out", f"{out} is neither a folder nor a .png file", "name a folder or a file like rig.png")
    return out / f"{name}.png"


def _check_mode(truth: Truth, mode: int | None) -> None:
    from vgvt.data import InputError

    count = truth.as_tested[0].natural_frequency_hz.size
    if mode is not None and mode > count:
        raise InputError("--mode", f"there is no mode {mode}", f"choose one from 1 to {count}")


def _render(scenario: Scenario, picture: Path, mode: int | None, width: int, height: int) -> Path | None:
    from vgvt.files.atomically import replacing
    from vgvt.simulation.picture import RenderingError, drawing_of, write_animation, write_picture

    drawing = drawing_of(scenario, width=width, height=height)
    animation = None if mode is None else picture.with_name(f"{picture.stem}-mode-{mode}.webp")
    try:
        with none_left_empty(picture.parent):
            with replacing(picture) as temporary:
                write_picture(drawing, temporary)
            if mode is not None and animation is not None:
                log(f"animate mode {mode} of {scenario.name}")
                with replacing(animation) as temporary:
                    write_animation(drawing, mode, temporary)
    except RenderingError as error:
        raise CommandError(str(error), f"{advice()}; or go without: --no-picture") from error
    return animation


def _document(scenario: Scenario, truth: Truth, picture: Path | None, animation: Path | None) -> dict[str, Any]:
    from vgvt.files.claim import mode_documents

    body, shown_hz = truth.rigid_body, _shown_hz(scenario)
    return {
        "scenario": scenario.name,
        "mass_kg": body.mass_kg,
        "cg_m": body.centre_of_gravity_m,
        "inertia_kg_m2": body.inertia_kg_m2,
        "modes": mode_documents(truth.bare.band(0.0, shown_hz)),
        "as_tested": mode_documents(truth.as_tested[0].band(0.0, shown_hz)),
        "coupled": mode_documents(_named(truth.coupled[0], truth.as_tested[0]).band(0.0, shown_hz)),
        "picture": picture,
        "animation": animation,
    }


def _print(
    scenario: Scenario,
    truth: Truth,
    hangs_deg: tuple[tuple[float, float], ...],
    picture: Path | None,
    animation: Path | None,
) -> None:
    from vgvt.view import modal_table

    body, shown_hz = truth.rigid_body, _shown_hz(scenario)
    centre = ", ".join(f"{without_sign(x, 4):.4f}" for x in body.centre_of_gravity_m)
    as_tested, coupled = _without_limits(truth.as_tested[0]), _named(truth.coupled[0], truth.as_tested[0])
    moments = ", ".join(f"{body.inertia_kg_m2[k, k]:.4g}" for k in range(3))
    show(
        f"{scenario.name}: {scenario.airframe.name}",
        f"mass {body.mass_kg:.4f} kg, centre of gravity ({centre}) m, Ixx, Iyy, Izz {moments} kg m² about it",
        hanging(hangs_deg),
        modal_table(truth.bare.band(0.0, shown_hz), f"modes of the bare airframe, up to {shown_hz:g} Hz"),
        modal_table(
            as_tested.band(0.0, shown_hz),
            f"modes as tested in run {truth.runs[0]}: hung, with sensors (--mode counts these)",
        ),
        modal_table(coupled.band(0.0, shown_hz), "resonances of the whole rig, shaker attached and driven"),
    )
    for words, path in (("picture", picture), ("animation", animation)):
        if path is not None:
            show(f"{words} in {path}")


def _without_limits(modes: ModalModel) -> ModalModel:
    """The modes without what the run's noise would allow: far below the band those limits say nothing."""
    return replace(modes, natural_frequency_std_hz=None, damping_ratio_std=None)


def _named(coupled: ModalModel, as_tested: ModalModel) -> ModalModel:
    """Resonances of the rig under the name of the mode as tested that they are, no name given twice."""
    from vgvt_scoreboard import counterparts

    if not as_tested.labels:
        return coupled
    theirs = counterparts(coupled, as_tested)
    return replace(coupled, labels=tuple(as_tested.labels[i] if i >= 0 else "" for i in theirs))


def _shown_hz(scenario: Scenario) -> float:
    return 2.0 * scenario.excitation.band_hz[1]
