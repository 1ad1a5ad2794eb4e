"""The examples run; each checks itself what it says. Their pages have their present text and code."""

import importlib.util
import re

import pytest
from conftest import root

examples = sorted((root / "examples" / "python").glob("*.py"))


def renderer():
    spec = importlib.util.spec_from_file_location("render_examples", root / "scripts" / "render_examples.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def outline(page):
    """The page without numbers, which may differ in their last digits between processors, and spaces."""
    return re.sub(r"[\s−+-]*\d[\d.,e+-]*|\s+", " ", page).split()


@pytest.mark.parametrize("path", examples, ids=lambda path: path.stem)
def test_example(path, tmp_path):
    pytest.importorskip("matplotlib")
    page, figures = renderer().rendered(path, "../pictures")
    assert "```text" in page
    for name, figure in figures.items():
        figure.savefig(tmp_path / name)
    written = root / "docs" / "python" / f"{path.stem}.md"
    assert written.exists(), "run scripts/render_examples.py"
    code = [block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL)]
    assert code == re.findall(r"```python\n(.*?)```", written.read_text(), re.DOTALL)
    assert outline(page) == outline(written.read_text()), "run scripts/render_examples.py"
