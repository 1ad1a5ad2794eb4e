"""The examples run; each checks itself what it says."""

import runpy

import pytest
from conftest import root

examples = sorted((root / "examples" / "python").glob("*.py"))


@pytest.mark.parametrize("path", examples, ids=lambda path: path.stem)
def test_example(path, capsys):
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out
