# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a result, for a notebook or a file."""
from __future__ import annotations

import html
import os
from pathlib import Path
from typing import Union

# The page's own script alone runs there (its policy names it by its digest), as of an origin of
# its own: it reaches neither the notebook nor anything else, whatever a file's texts may be.
FRAME = ('<iframe sandbox="allow-scripts allow-downloads" '
         'style="width:100%;height:40em;border:0" srcdoc="{}"></iframe>')


class Report:
    """One page that says what a result says: shown by a notebook, or saved as a file."""

    def __init__(self, page: str) -> None:
        self.html = page

    def _repr_html_(self) -> str:
        return FRAME.format(html.escape(self.html, quote=True))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> Path:
        """Write the page to the file, and give its path."""
        to = Path(path)
        to.write_text(self.html, encoding="utf-8")
        return to
