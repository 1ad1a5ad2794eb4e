"""The wheel: made without a network, complete, and honest about what it needs of the system."""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

import pytest
from conftest import root

import hydrapod

package = pathlib.Path(hydrapod.__file__).parent
of_compilers = re.compile(r"lib(c|m|stdc\+\+|gcc_s)\.so\.\d+|ld-linux.*\.so\.\d+")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """As pip makes it, of the extension that is built already: the build tool is one that does nothing."""
    for module in ("pip", "setuptools", "wheel"):
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"there is no {module}")
    folder = tmp_path_factory.mktemp("wheel")
    shutil.copytree(root / "python", folder / "source", ignore=shutil.ignore_patterns("build", "*.egg-info"))
    build = folder / "build"
    (build / "python" / "hydrapod").mkdir(parents=True)
    (build / "build.ninja").touch()
    (extension,) = package.glob("_core*.so")
    shutil.copy(extension, build / "python" / "hydrapod")
    (folder / "tools").mkdir()
    tool = folder / "tools" / "cmake"
    tool.write_text("#!/bin/sh\n")
    tool.chmod(0o755)
    done = subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--no-index", "--wheel-dir",
         str(folder), str(folder / "source")], capture_output=True, text=True,
        env={**os.environ, "PATH": f"{folder / 'tools'}:{os.environ['PATH']}", "HYDRAPOD_BUILD_FOLDER": str(build)})
    assert done.returncode == 0, done.stdout + done.stderr
    (made,) = folder.glob("*.whl")
    return made


def test_it_is_complete(wheel, tmp_path):
    """Every file of the package is in it, and it works from there."""
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        archive.extractall(tmp_path)
    own = {f"hydrapod/{path.name}" for path in package.iterdir() if path.is_file()}
    assert {name for name in names if not name.split("/")[0].endswith(".dist-info")} == own
    code = ("import hydrapod, sys; assert hydrapod.__file__.startswith(sys.argv[2]), hydrapod.__file__; "
            "print(len(hydrapod.modes(hydrapod.read_machine(sys.argv[1])).frequency_hz))")
    done = subprocess.run([sys.executable, "-c", code, str(root / "models" / "zhang-jiang-2021.toml"), str(tmp_path)],
                          capture_output=True, text=True, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert (done.returncode, done.stdout) == (0, "18\n"), done.stderr


def test_it_needs_what_its_metadata_say(wheel, tmp_path):
    """Libraries of the compiler, and those that are named; found by the system's own search."""
    with zipfile.ZipFile(wheel) as archive:
        (metadata,) = (name for name in archive.namelist() if name.endswith("/METADATA"))
        text = archive.read(metadata).decode()
        (extension,) = (name for name in archive.namelist() if name.endswith(".so"))
        archive.extract(extension, tmp_path)
    found = subprocess.run(["readelf", "--dynamic", "--wide", str(tmp_path / extension)], capture_output=True, text=True,
                           check=True).stdout
    needed = {name for name in re.findall(r"\(NEEDED\).*\[(.*)\]", found) if not of_compilers.fullmatch(name)}
    named = set(re.findall(r"\blib[\w+-]+\.so\.\d+", text))
    assert needed <= named, f"not named: {sorted(needed - named)}"
    (numpy,) = re.findall(r"^Requires-Dist: numpy\b(.*)$", text, re.MULTILINE)
    assert "<2" in numpy  # Debian's pybind11 does not know NumPy 2
    assert f"\nVersion: {hydrapod.__version__}\n" in text
