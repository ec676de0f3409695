"""Make one HTML file of template, style and modules."""

from __future__ import annotations

import html
import re
from importlib.resources import files

__all__ = ["bundle", "bundled_script"]

_IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([a-z_]+)\.js";\n', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)
_PLACE = re.compile(r"<!--(\w+)-->|/\*(\w+)\*/")


def bundle(title: str, payload: str) -> str:
    """Return the page.

    Parameters
    ----------
    title : str
        Plain text.
    payload : str
        The packed data, in base 64.
    """
    parts = {
        "title": html.escape(title),
        "style": _text("style.css"),
        "script": bundled_script(),
        "payload": payload,
    }
    return _PLACE.sub(lambda found: parts[found[1] or found[2]], _text("template.html"))


def bundled_script() -> str:
    """Join the modules that main.js needs, each a function that returns what it exports."""
    pieces: list[str] = []
    _collect("main", pieces, set())
    return "\n".join(pieces)


def _collect(name: str, pieces: list[str], seen: set[str]) -> None:
    """Append a module after those it imports."""
    if name in seen:
        return
    seen.add(name)
    source = _text(f"modules/{name}.js")
    for found in _IMPORT.finditer(source):
        _collect(found[2], pieces, seen)
    exported = ", ".join(found[1] for found in _EXPORT.finditer(source))
    body = _EXPORT.sub("", _IMPORT.sub(r"const {\1} = module_\2;\n", source))
    pieces.append(f"const module_{name} = (() => {{\n{body}return {{ {exported} }};\n}})();")


def _text(name: str) -> str:
    return files("roundelay.output.page").joinpath(name).read_text(encoding="utf-8")
