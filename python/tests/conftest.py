"""Where things are, and what several tests use."""

import json
import os
import pathlib
import subprocess

import pytest

import hydrapod

root = pathlib.Path(__file__).resolve().parents[2]
models = sorted((root / "models").glob("*.toml"))
sanitized = "HYDRAPOD_SANITIZED" in os.environ  # the extension is, with its run-time library in LD_PRELOAD
program = os.environ.get("HYDRAPOD_PROGRAM", str(root / "build/test/apps/hydrapod/hydrapod"))


def call_program(*arguments, **options):
    """The program, which has a run-time library of its own where it is sanitized."""
    environment = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
    return subprocess.run([program, *map(str, arguments)], **{
        "capture_output": True, "text": True, "cwd": root, "env": environment, **options})


def command_line(*arguments):
    """The JSON that the command line prints, without what tells how it was called."""
    done = call_program(*arguments)
    assert done.returncode == 0 or done.stdout.startswith("{"), done.stderr
    document = json.loads(done.stdout)
    del document["reproduction"]
    return document


def program_of(*arguments):
    """Runs the command line, which must do what it was asked for."""
    done = call_program(*arguments)
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="session", params=models, ids=lambda path: path.stem)
def model(request):
    return str(request.param)


@pytest.fixture(scope="session")
def heavy():
    return hydrapod.read_machine(root / "models" / "heavy-platform.toml")


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """A short record of the virtual rig and the modes identified in it, as files."""
    folder = tmp_path_factory.mktemp("run")
    path = str(folder / "run.mat")
    machine = hydrapod.read_machine(root / "models" / "heavy-platform.toml")
    done = hydrapod.rig(machine, path, duration="20 s", rate="400 Hz", seed=7)
    assert done.finished and done.samples == 8000
    return path


def record_of_published_machine(folder, duration):
    """It shows six modes."""
    path = str(folder / "run.h5")
    machine = hydrapod.read_machine(root / "models" / "zhang-jiang-2021.toml")
    hydrapod.rig(machine, path, excite="white all=0.2 mm", duration=duration, seed=3)
    return path


@pytest.fixture(scope="session")
def strong_run(tmp_path_factory):
    return record_of_published_machine(tmp_path_factory.mktemp("strong"), "30 s")


@pytest.fixture(scope="session")
def long_run(tmp_path_factory):
    """Responses of it take more than the 20 ms that lie between two calls of a progress."""
    return record_of_published_machine(tmp_path_factory.mktemp("long"), "180 s")
