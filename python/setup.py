"""pip install ./python --no-build-isolation: CMake builds the extension, without a network.

HYDRAPOD_BUILD_FOLDER names a build folder of CMake to use (and use again); default: build/pip of the repository.
"""

import os
import pathlib
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

root = pathlib.Path(__file__).resolve().parent.parent


class CMakeBuild(build_ext):
    def build_extension(self, extension: Extension) -> None:
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        folder = pathlib.Path(os.environ.get("HYDRAPOD_BUILD_FOLDER", root / "build" / "pip"))
        if not (folder / "build.ninja").exists():
            subprocess.run(
                ["cmake", "-S", str(root), "-B", str(folder), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                 "-DHYDRAPOD_BUILD_PYTHON=ON", "-DHYDRAPOD_BUILD_TESTS=OFF",
                 f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", str(folder), "--target", "python_core"], check=True)
        (built,) = (folder / "python" / "hydrapod").glob("_core*.so")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(built.read_bytes())


setup(ext_modules=[Extension("hydrapod._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
