"""A page that is one HTML file: its style, its figures' data and the drawing code are inside, nothing is fetched."""

from __future__ import annotations

import html
import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from vgvt._version import __version__

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
FOOTER = "<footer>vgvt "
"""How the last line begins, before the version: by it a page of vgvt is known."""


def html_page(
    title: str,
    sections: Mapping[str, tuple[str, str]],
    figures: Mapping[str, Any],
    scripts: Sequence[str] = ("figures.js",),
) -> str:
    """The page: ``sections`` by anchor are (heading, HTML), empty ones left out; ``figures`` are JSON by element id.

    ``scripts`` are files of ``vgvt/view/page`` that run after plotly, in order.
    """
    shown = {key: value for key, value in sections.items() if value[1]}
    nav = "".join(f'<a href="#{key}">{escaped(name)}</a>' for key, (name, _) in shown.items())
    main = "".join(
        f'<section id="{key}" aria-labelledby="{key}-title"><h2 id="{key}-title">{escaped(name)}</h2>{body}</section>'
        for key, (name, body) in shown.items()
    )
    page = files("vgvt.view") / "page"
    style = (page / "style.css").read_text(encoding="utf-8")
    code = "\n".join(f"<script>{(page / name).read_text(encoding='utf-8')}</script>" for name in scripts)
    data = "".join(
        f'<script type="application/json" id="{key}">{_inline_json(value)}</script>' for key, value in figures.items()
    )
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<link rel="icon" href="data:,"><title>{escaped(title)}</title><style>{style}</style></head>\n<body>'
        f'<header><h1>{escaped(title)}</h1><nav aria-label="Sections">{nav}</nav></header>\n<main>{main}</main>\n'
        f"{FOOTER}{escaped(__version__)}. This page holds all its data and asks nothing of the network.</footer>\n"
        f"{data}\n<script>{_plotly_js()}</script>\n{code}</body></html>\n"
    )


def figure_element(data: str, label: str, attributes: str = "") -> str:
    """The place where the figure of the element ``data`` is drawn."""
    return f'<div class="figure" data-figure="{data}" role="figure" aria-label="{escaped(label)}"{attributes}></div>'


def figure_data(figure: Figure) -> Any:
    """A plotly figure as JSON data."""
    return json.loads(figure.to_json())


def escaped(text: object) -> str:
    """Text that cannot become markup."""
    return html.escape(str(text), quote=True)


def _plotly_js() -> str:
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs()).replace("</script", "<\\/script")


def _inline_json(value: object) -> str:
    """JSON that cannot end the script element it stands in."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
