"""Short descriptions of objects for notebooks, as HTML."""

from collections.abc import Mapping
from html import escape


class Text(str):
    """Lines that a notebook shows as they are, without quotes."""

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self)}</pre>"


def as_table(title: str, rows: Mapping[str, object]) -> str:
    """Return a table with a title and a row for each name and value."""
    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th>'
        f'<td style="text-align:left">{escape(str(value))}</td></tr>'
        for name, value in rows.items()
    )
    return f"<table><caption><b>{escape(title)}</b></caption>{cells}</table>"
