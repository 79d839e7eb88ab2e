"""Runs the examples and renders them: python python/notebooks.py [FOLDER], default
target/notebooks.

An example is a script in the percent format: `# %%` begins a cell of code, `# %% [markdown]` one
of text. Each becomes a notebook (`NAME.ipynb`) and a page (`NAME.md`), both with what the cells
have printed. A cell that fails ends the script.
"""

from __future__ import annotations

import contextlib
import io
import json
import pathlib
import sys
from typing import Any

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "python" / "examples"
CODE, TEXT = "# %%", "# %% [markdown]"


def cells(text: str) -> list[tuple[str, str]]:
    """Return the cells of a script: kind, `markdown` or `code`, and source."""
    found: list[tuple[str, list[str]]] = []
    for line in text.splitlines():
        if line.startswith(CODE):
            found.append(("markdown" if line.startswith(TEXT) else "code", []))
        elif found:
            kind, lines = found[-1]
            lines.append(line.removeprefix("#").removeprefix(" ") if kind == "markdown" else line)
    return [(kind, "\n".join(lines).strip()) for kind, lines in found]


def run(all_cells: list[tuple[str, str]], name: str) -> list[str]:
    """Run the cells of code one after the other, and return what each has printed."""
    names: dict[str, Any] = {"__name__": "__main__"}
    printed = []
    for kind, source in all_cells:
        out = io.StringIO()
        if kind == "code":
            with contextlib.redirect_stdout(out):
                exec(compile(source, name, "exec"), names)
        printed.append(out.getvalue())
    return printed


def notebook(all_cells: list[tuple[str, str]], printed: list[str]) -> str:
    """Return the notebook in the format 4.5."""
    made = []
    for i, ((kind, source), text) in enumerate(zip(all_cells, printed)):
        cell: dict[str, Any] = {
            "cell_type": kind,
            "id": f"cell-{i}",
            "metadata": {},
            "source": source.splitlines(keepends=True),
        }
        if kind == "code":
            lines = text.splitlines(keepends=True)
            stream = {"output_type": "stream", "name": "stdout", "text": lines}
            cell |= {"execution_count": None, "outputs": [stream] if text else []}
        made.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {
        "cells": made,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def page(all_cells: list[tuple[str, str]], printed: list[str]) -> str:
    """Return the page in Markdown."""
    parts = []
    for (kind, source), text in zip(all_cells, printed):
        parts.append(source if kind == "markdown" else f"```python\n{source}\n```")
        if text:
            parts.append(f"```text\n{text.rstrip()}\n```")
    return "\n\n".join(parts) + "\n"


def main() -> None:
    """Render all examples."""
    folder = pathlib.Path(sys.argv[1] if sys.argv[1:] else ROOT / "target" / "notebooks")
    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted(EXAMPLES.glob("*.py")):
        own = cells(path.read_text(encoding="utf-8"))
        printed = run(own, str(path))
        (folder / f"{path.stem}.ipynb").write_text(notebook(own, printed), encoding="utf-8")
        (folder / f"{path.stem}.md").write_text(page(own, printed), encoding="utf-8")
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main()
