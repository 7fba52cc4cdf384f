"""The package `obscura`: pip install --no-build-isolation ./src/python

The extension is built by CMake from the tree that this folder is in, into build-python; OBSCURA_BUILD names another build
folder, one that was configured with OBSCURA_PYTHON.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

try:
    import pybind11
except ModuleNotFoundError:
    sys.exit(f"obscura: {sys.executable} has no pybind11: take the Python that has, Debian's /usr/bin/python3 with "
             "python3-pybind11 and python3-numpy, as docs/python.md says")
from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# what setuptools writes does not lie in the sources
OUT = ROOT / "build-python"
OUT.mkdir(exist_ok=True)

VERSION = re.search(r"project\(obscura\s+VERSION\s+([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)

# what this pybind11 was made for: NumPy 2 has another layout
NUMPY = "numpy" if tuple(map(int, pybind11.__version__.split(".")[:2])) >= (2, 12) else "numpy<2"

DESCRIPTION = """\
Rooms of bodies, simulated and filmed without a window: see docs/python.md of the source tree.

Obscura's own code is under the MIT license. It links FFmpeg's libraries, which Debian builds with x264 and x265, under the GNU
General Public License, version 2 or later. A copy linked with them may be passed on under the terms of the GPL alone, with
the source of all of it. Films and pictures that are made with it are yours.
"""


class Build(build_ext):
    def build_extension(self, extension):
        folder = Path(os.environ.get("OBSCURA_BUILD", OUT))
        if "OBSCURA_BUILD" not in os.environ:
            subprocess.check_call(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                                   "-DOBSCURA_PYTHON=ON", "-DOBSCURA_TESTS=OFF", f"-DPython3_EXECUTABLE={sys.executable}"])
        subprocess.check_call(["cmake", "--build", folder, "--target", "obscura_python"])
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        for made in (next((folder / "python/obscura").glob("_obscura*.so")), folder / "python/obscura/_keys.pyi"):
            shutil.copy2(made, target.parent / (target.name if made.suffix == ".so" else made.name))


setup(
    name="obscura",
    version=VERSION,
    description="Rooms of bodies, simulated and filmed without a window",
    long_description=DESCRIPTION,
    long_description_content_type="text/plain",
    license="MIT; linked with FFmpeg's libraries as Debian builds them GPL-2.0-or-later",
    python_requires=">=3.11",
    install_requires=[NUMPY],
    packages=["obscura"],
    package_data={"obscura": ["*.pyi", "py.typed"]},
    ext_modules=[Extension("obscura._obscura", sources=[])],
    cmdclass={"build_ext": Build},
    options={"build": {"build_base": str(OUT / "setuptools")}, "egg_info": {"egg_base": str(OUT)}},
)
