#!/usr/bin/python3
"""Runs examples/python/*.py, which are in percent format, and writes them with what they print as docs/python/*.md.

Usage: scripts/render_examples.py [--folder DIR] [EXAMPLE]...     (from `./hydrapod python`; needs matplotlib)

A cell begins with "# %%"; "# %% [markdown]" begins text. A cell that assigns `figure` shows it as a picture.
"""

import argparse
import contextlib
import io
import pathlib
import re

root = pathlib.Path(__file__).resolve().parent.parent


def cells(source):
    """(is text, content) of each cell."""
    for part in re.split(r"^# %%", source, flags=re.MULTILINE)[1:]:
        head, _, body = part.partition("\n")
        if "[markdown]" in head:
            yield True, "\n".join(line[2:] for line in body.strip().splitlines())
        else:
            yield False, body.strip("\n")


def rendered(example, pictures):
    """The page, and the pictures by name; `pictures`: where the page finds them."""
    namespace = {"__file__": str(example), "__name__": "__main__"}
    page, figures = [], {}
    for is_text, content in cells(example.read_text()):
        if is_text:
            page.append(content)
            continue
        namespace.pop("figure", None)
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile(content, str(example), "exec"), namespace)  # the repository's own file
        page.append(f"```python\n{content.strip()}\n```")
        if output.getvalue().strip():
            page.append(f"```text\n{output.getvalue().rstrip()}\n```")
        if "figure" in namespace:
            name = f"python-{example.stem}-{len(figures) + 1}.png"
            figures[name] = namespace["figure"]
            page.append(f"![Figure {len(figures)}]({pictures}/{name})")
    page.append(f"Written by `scripts/render_examples.py` from `examples/python/{example.name}`.")
    return "\n\n".join(page) + "\n", figures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--folder", type=pathlib.Path, default=root / "docs")
    parser.add_argument("examples", nargs="*", type=pathlib.Path)
    asked = parser.parse_args()
    for folder in (asked.folder / "python", asked.folder / "pictures"):
        folder.mkdir(parents=True, exist_ok=True)
    for example in asked.examples or sorted((root / "examples" / "python").glob("*.py")):
        page, figures = rendered(example.resolve(), "../pictures")
        (asked.folder / "python" / f"{example.stem}.md").write_text(page)
        for name, figure in figures.items():
            figure.savefig(asked.folder / "pictures" / name, dpi=80)


if __name__ == "__main__":
    main()
