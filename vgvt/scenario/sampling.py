"""Does the acquisition fit what it samples: the band, the filters of its channels, and a record of sensible length."""

from __future__ import annotations

import math

from vgvt.scenario.base import MisfitError
from vgvt.scenario.instruments import Accelerometers, Acquisition, Transducer
from vgvt.scenario.rig import Excitation

MOST_SAMPLES = 1e9
"""Of a campaign, held in memory at once: 8 GB, sixty times the longest that is bundled."""


def check_sampling(
    excitation: Excitation,
    acquisition: Acquisition,
    accelerometers: Accelerometers,
    transducer: Transducer,
    drives: int,
) -> None:
    """MisfitError unless ``acquisition`` samples the band and its filters, no moment, and no more than can be held.

    ``drives`` is the number of exciters, of which each has a command and a force.
    """
    _check_rate(excitation, acquisition, accelerometers, transducer)
    _check_shortest(excitation)
    _check_longest(excitation, acquisition, drives)


def _check_rate(
    excitation: Excitation, acquisition: Acquisition, accelerometers: Accelerometers, transducer: Transducer
) -> None:
    top_hz, rate_hz = excitation.band_hz[1], acquisition.sample_rate_hz
    if top_hz >= rate_hz / 2:
        raise MisfitError(
            ("acquisition", "sample_rate_hz"),
            f"is {rate_hz:g}, but the excitation goes up to {top_hz:g} Hz",
            f"Sample faster than {2 * top_hz:g} Hz, or excite less far up.",
            (
                MisfitError(
                    ("excitation", "stop_hz" if excitation.stop_hz == top_hz else "start_hz"),
                    f"is {top_hz:g}, but sampled at {rate_hz:g} Hz only what is below {rate_hz / 2:g} Hz can be seen",
                    f"Excite less far up, or sample faster than {2 * top_hz:g} Hz.",
                ),
            ),
        )
    for table, instrument in (("accelerometers", accelerometers), ("transducer", transducer)):
        if instrument.high_pass_hz >= rate_hz / 2:
            raise MisfitError(
                (table, "high_pass_hz"),
                f"is {instrument.high_pass_hz:g}, but sampled at {rate_hz:g} Hz only what is below {rate_hz / 2:g} Hz "
                "can be seen",
                f"Write the corner of the AC coupling, far below the {excitation.band_hz[0]:g} Hz of the band's start, "
                "or 0 for none.",
            )


def _check_shortest(excitation: Excitation) -> None:
    """A dwell and a hit are checked where they are described; here it is what else fades in and out."""
    if excitation.kind in ("stepped-sine", "impact"):
        return
    middle_hz = sum(excitation.band_hz) / 2
    # To the rounding of one cycle that a scenario states.
    recorded_s = excitation.burst_s - excitation.before_record_s
    if recorded_s * middle_hz < 1 - 1e-9:
        key = "duration_s" if excitation.burst_fraction is None else "burst_fraction"
        key = "unrecorded_s" if excitation.before_record_s > 0 else key
        raise MisfitError(
            ("excitation", key),
            f"is {getattr(excitation, key):g} and leaves {recorded_s:.3g} s, less than a cycle at "
            f"{middle_hz:g} Hz, the middle of the band",
            f"Excite for {1 / middle_hz:.3g} s at least, and better for many cycles of every mode.",
        )


def _check_longest(excitation: Excitation, acquisition: Acquisition, drives: int) -> None:
    rate_hz, repeats = acquisition.sample_rate_hz, acquisition.repeats
    channels = sum(len(nodes) + 2 * drives for nodes in acquisition.runs)
    once = excitation.whole_s * rate_hz * channels
    if once * repeats <= MOST_SAMPLES:
        return
    gigabytes = f"{8 * once * repeats / 1e9:.3g} GB of samples"
    most = f"more than the {8 * MOST_SAMPLES / 1e9:g} GB that a campaign may have"
    columns = f"{channels} channels of all runs" + (f", {repeats} times," if repeats > 1 else "")
    fast = _too_fast(excitation, rate_hz, columns, f"{gigabytes}, {most}", channels * repeats)
    silence_s = excitation.lead_in_s + excitation.ring_down_s
    longest_s = MOST_SAMPLES / (rate_hz * channels * repeats) - silence_s
    long = MisfitError(
        ("excitation", "duration_s"),
        f"is {excitation.duration_s:g}: {columns} at {rate_hz:g} Hz make {gigabytes}, {most}",
        f"Write at most {longest_s:.3g}, or sample more slowly."
        if longest_s > 0
        else "Sample more slowly, or shorten the silence around it.",
        (fast, *_too_silent(excitation, MOST_SAMPLES / (rate_hz * channels), f"{gigabytes}, {most}")),
    )
    if once > MOST_SAMPLES:
        raise long
    raise MisfitError(
        ("acquisition", "repeats"),
        f"is {repeats} and makes {gigabytes}, {most}",
        f"Repeat {math.floor(MOST_SAMPLES / once)} times at most, or make another campaign of the rest.",
        (long, fast),
    )


def _too_fast(excitation: Excitation, rate_hz: float, columns: str, too_much: str, channels: int) -> MisfitError:
    """What a campaign that is too large says of its sample rate."""
    fastest_hz = math.floor(MOST_SAMPLES / (excitation.whole_s * channels))
    needed_hz = 2 * excitation.band_hz[1]
    return MisfitError(
        ("acquisition", "sample_rate_hz"),
        f"is {rate_hz:g}: {columns} for {excitation.whole_s:g} s make {too_much}",
        f"Write at most {fastest_hz}, and more than {needed_hz:g} for the band, or excite for less time."
        if fastest_hz > needed_hz
        else f"The band needs more than {needed_hz:g}: excite for less time.",
    )


def _too_silent(excitation: Excitation, most_s: float, too_much: str) -> list[MisfitError]:
    """What a campaign that is too large says of the silence before and after, of which either may be all of it."""
    told = []
    for key in ("lead_in_s", "ring_down_s"):
        silence_s = getattr(excitation, key)
        longest_s = most_s - (excitation.whole_s - silence_s)
        advice = (
            f"Write at most {longest_s:.3g}."
            if longest_s > 0
            else "Write less, and make the rest of the record shorter."
        )
        told.append(MisfitError(("excitation", key), f"is {silence_s:g}, and the campaign makes {too_much}", advice))
    return told
