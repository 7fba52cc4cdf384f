"""Golden tests of obscura in pytest: each scene with a [golden] table is a test.

    pytest -p obscura_pytest scenes               this file beside conftest.py, or its folder in PYTHONPATH
    pytest_plugins = ["obscura_pytest"]           or so, in conftest.py at the top

A test that fails shows for each moment what differs, why, and where the pictures lie. docs/golden.md has more.
"""

import json
import os
import pathlib
import re
import shlex
import subprocess

import pytest


def pytest_addoption(parser):
    group = parser.getgroup("obscura", "golden images of obscura")
    group.addoption("--obscura", metavar="PROGRAM", help="the program [ini obscura, $OBSCURA, obscura]")
    group.addoption("--obscura-update", action="store_true", help="take what there is now as the reference")
    parser.addini("obscura", "the program", default="")
    parser.addini("obscura_references", "the folder of the references [golden/ beside each scene]", default="")
    parser.addini("obscura_arguments", "further arguments of `obscura golden`, as a shell has them", default="")


def pytest_collect_file(parent, file_path):
    if file_path.suffix == ".toml" and table_line(file_path):
        return SceneFile.from_parent(parent, path=file_path)
    return None


def table_line(path):
    """The line of a scene's [golden] table, from 1; 0 where it has none."""
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), start=1):
        if re.match(r"\s*\[\s*golden\s*\]", line):
            return number
    return 0


class SceneFile(pytest.File):
    def collect(self):
        yield SceneTest.from_parent(self, name="golden")


class SceneTest(pytest.Item):
    def runtest(self):
        outcome = run(self.config, self.path)
        for moment in outcome["moments"]:
            for kind, path in moment["pictures"].items():
                self.user_properties.append((f"{moment['scene']} {moment['time']} {kind}", absolute(self.config, path)))
        if outcome["exit"] != 0:
            raise GoldenFailure(outcome)

    def repr_failure(self, excinfo, style=None):
        if isinstance(excinfo.value, GoldenFailure):
            return excinfo.value.text(self.config)
        if isinstance(excinfo.value, ProgramFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo)

    def reportinfo(self):
        return self.path, max(table_line(self.path) - 1, 0), f"golden {self.path.stem}"


class ProgramFailure(Exception):
    """obscura did not come to a verdict."""


class GoldenFailure(Exception):
    """Something differs, or is missing, or cannot be simulated."""

    def __init__(self, outcome):
        super().__init__("golden images differ")
        self.outcome = outcome

    def text(self, config):
        lines = []
        for moment in self.outcome["moments"]:
            if moment["state"] in ("same", "tolerated", "updated"):
                continue
            time = "" if moment["time"] is None else f", t = {moment['time']} s"
            lines.append(f"{moment['scene']}{time}: {moment['state']}")
            lines += [f"    {line}" for line in moment["lines"]]
            if moment["state"] == "differs":
                lines.append(f"    expected    {absolute(config, moment['reference'])}")
            lines += [f"    {kind:<11} {absolute(config, path)}" for kind, path in moment["pictures"].items()]
        return "\n".join(lines)


def absolute(config, path):
    return str(pathlib.Path(config.rootpath, path))


def run(config, scene):
    """What `obscura golden` says of one scene."""
    program = config.getoption("--obscura") or config.getini("obscura") or os.environ.get("OBSCURA") or "obscura"
    command = [program, "golden", "--format", "json", "--jobs", "1"]
    if config.getini("obscura_references"):
        command += ["--references", config.getini("obscura_references")]
    if config.getoption("--obscura-update"):
        command.append("--update")
    command += shlex.split(config.getini("obscura_arguments"))
    try:
        command.append(str(scene.relative_to(config.rootpath)))
    except ValueError:
        command.append(str(scene))
    try:
        made = subprocess.run(command, cwd=config.rootpath, capture_output=True, text=True, check=False)
    except OSError as error:
        raise ProgramFailure(f"{program}: {error.strerror}; --obscura names another program") from error
    try:
        return json.loads(made.stdout)
    except ValueError:
        raise ProgramFailure(f"{shlex.join(command)}: exit code {made.returncode}\n{made.stderr}") from None
