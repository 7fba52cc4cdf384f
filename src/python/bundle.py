#!/usr/bin/env python3
"""bundle.py WHEEL FOLDER: a wheel that needs no other package of the system, of one that pip made here.

The libraries that the module needs, and OSMesa and FFmpeg's, which it opens by name, go into obscura.libs/, fonts into obscura/fonts/.
Each library but those gets a name of its own, with a part of its checksum: another module of the same process that brings
its own copy of, say, libpng has nothing to do with ours. Left to the system are glibc, libgcc and libstdc++, which cannot
be there twice; the wheel's tag says how new glibc must be (PEP 600).

The packages that all of this is from, their versions and their licenses lie beside the metadata. Needs patchelf and dpkg.
"""

from __future__ import annotations

import base64
import hashlib
import os
import re
import shutil
import stat
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

# glibc, and what is part of every C++ program
SYSTEM = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|util|resolv|mvec|stdc\+\+|gcc_s))\.so\.\d+$|linux-vdso")
OPENED = ["libOSMesa.so.8", "libavcodec.so", "libavformat.so", "libavutil.so", "libswscale.so"]  # the newest of FFmpeg's
FONTS = ["Inter-Regular.otf", "Inter-Medium.otf", "Inter-Bold.otf", "STIX-Regular.otf", "STIX-Italic.otf", "STIX-BoldItalic.otf"]
LICENSE = "GPL-3.0-or-later, with all that is bundled; obscura itself MIT"
MORE = """

This wheel contains libraries and fonts of Debian, each under its own license: `{info}/bundled/PACKAGES` lists the packages that
they are from with their versions, and beside it lies the copyright file of each. libx264 and libx265, which libavcodec
needs, are under the GNU General Public License, version 2 or later; libcrypto is under the Apache License 2.0, which goes together
with version 3 alone. So the wheel as a whole may be passed on under the terms of the GPL, version 3 or later, and with the
source of these packages, in these versions, as snapshot.debian.org has it.
"""


def run(*command: str | Path) -> str:
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def needed(library: Path) -> dict[str, Path]:
    """All libraries that this one needs, and those that they need, by name."""
    found = {}
    for line in run("ldd", library).splitlines():
        if "not found" in line:
            sys.exit(f"bundle.py: {library.name}: {line.strip()}")
        if match := re.match(r"\s*(\S+) => (\S+) ", line):
            if not SYSTEM.match(match[1]):
                found[match[1]] = Path(match[2])
    return found


def opened(name: str) -> Path:
    """A library that is opened by name, where the system's loader finds it; of several versions that of the headers."""
    known = {line.split()[0]: Path(line.split()[-1]) for line in run("/sbin/ldconfig", "-p").splitlines() if "=>" in line}
    if name not in known:
        sys.exit(f"bundle.py: no {name} (apt-get install libosmesa6 libavformat-dev libswscale-dev)")
    # libavcodec.so is a link to the library, whose own name it is opened by
    own = re.search(r"SONAME.*\[(.*)\]", run("readelf", "-d", known[name]))[1]
    return known.get(own, known[name])


def own_name(name: str, path: Path) -> str:
    stem, dot, rest = name.partition(".so")
    return f"{stem}-{hashlib.sha256(path.read_bytes()).hexdigest()[:8]}{dot}{rest}"


def put_libraries(module: Path, folder: Path) -> list[Path]:
    """Copies what the module needs into a folder; answers where it is from."""
    by_name = [opened(name) for name in OPENED]
    libraries = needed(module)
    for library in by_name:
        libraries |= needed(library)
    libraries |= {library.name: library for library in by_name}
    names = {name: own_name(name, path) for name, path in libraries.items()}
    names |= {library.name: library.name for library in by_name}
    folder.mkdir()

    def point(library: Path, to: str) -> None:
        # one thing at a time: patchelf mixes names up where it changes several
        for name in run("patchelf", "--print-needed", library).split():
            if names.get(name, name) != name:
                run("patchelf", "--replace-needed", name, names[name], library)
        run("patchelf", "--set-rpath", to, library)

    for name, path in libraries.items():
        copy = folder / names[name]
        shutil.copyfile(path, copy)
        copy.chmod(0o755)
        run("patchelf", "--set-soname", names[name], copy)
        point(copy, "$ORIGIN")
    point(module, "$ORIGIN/../obscura.libs")
    return list(libraries.values())


def font(name: str) -> Path:
    for path in sorted(Path("/usr/share/fonts").rglob(name)):
        return path
    sys.exit(f"bundle.py: no font {name} (apt-get install fonts-inter fonts-stix)")


def package_of(path: Path) -> str:
    """Of Debian. A path below /lib may be known as one below /usr/lib, and the other way."""
    real = path.resolve()
    for each in (path, real, str(real).removeprefix("/usr"), "/usr" + str(path)):
        answer = subprocess.run(["dpkg-query", "-S", str(each)], capture_output=True, text=True)
        if answer.returncode == 0:
            return answer.stdout.splitlines()[0].rsplit(": ", 1)[0].split(",")[0]
    sys.exit(f"bundle.py: {path} is of no package")


def put_licenses(files: list[Path], folder: Path) -> None:
    folder.mkdir()
    packages = sorted({package_of(path) for path in files})
    lines = ["package version source source-version"]
    for package in packages:
        lines.append(run("dpkg-query", "-W", "-f", "${Package} ${Version} ${source:Package} ${source:Version}", package))
        name = package.split(":")[0]
        shutil.copyfile(f"/usr/share/doc/{name}/copyright", folder / f"{name}.copyright")
    (folder / "PACKAGES").write_text("\n".join(lines) + "\n")


def tag(libraries: list[Path]) -> str:
    """The platform: the newest glibc of which any of them asks for a symbol."""
    newest = max(tuple(map(int, version)) for library in libraries
                 for version in re.findall(r"GLIBC_(\d+)\.(\d+)", run("readelf", "-W", "--version-info", library)))
    return f"manylinux_{newest[0]}_{newest[1]}_{os.uname().machine}"


def pack(tree: Path, info: Path, wheel: Path) -> None:
    """The same bytes each time: files by name, all of one moment."""
    record = info / "RECORD"
    record.unlink()
    files = sorted(path for path in tree.rglob("*") if path.is_file())
    lines = []
    for path in files:
        digest = base64.urlsafe_b64encode(hashlib.sha256(path.read_bytes()).digest()).rstrip(b"=").decode()
        lines.append(f"{path.relative_to(tree)},sha256={digest},{path.stat().st_size}")
    record.write_text("\n".join([*lines, f"{record.relative_to(tree)},,"]) + "\n")
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for path in [*files, record]:
            entry = zipfile.ZipInfo(str(path.relative_to(tree)))
            entry.external_attr = (stat.S_IFREG | (0o755 if ".so" in path.name else 0o644)) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, path.read_bytes(), compresslevel=9)


def main(source: Path, out: Path) -> None:
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder)
        with zipfile.ZipFile(source) as archive:
            archive.extractall(tree)
        info = next(tree.glob("*.dist-info"))
        module = next((tree / "obscura").glob("_obscura*.so"))
        run("strip", "--strip-unneeded", module)

        files = put_libraries(module, tree / "obscura.libs")
        (tree / "obscura/fonts").mkdir()
        for name in FONTS:
            files.append(font(name))
            shutil.copyfile(files[-1], tree / "obscura/fonts" / name)
        put_licenses(files, info / "bundled")

        platform = tag([module, *(tree / "obscura.libs").iterdir()])
        metadata = info / "METADATA"
        text = re.sub(r"^License: .*", f"License: {LICENSE}", metadata.read_text(), flags=re.M)
        metadata.write_text(text.rstrip() + MORE.format(info=info.name))
        (info / "WHEEL").write_text(re.sub(r"^(Tag: .*-)[^-\n]+$", rf"\g<1>{platform}", (info / "WHEEL").read_text(), flags=re.M))
        wheel = out / (source.stem.rpartition("-")[0] + f"-{platform}.whl")
        out.mkdir(parents=True, exist_ok=True)
        pack(tree, info, wheel)
        print(wheel)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("bundle.py WHEEL FOLDER")
    main(Path(sys.argv[1]), Path(sys.argv[2]))
