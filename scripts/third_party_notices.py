#!/usr/bin/env python3
"""Writes THIRD-PARTY-NOTICES.txt: the crates that the libraries and FMUs of stickslip contain on any platform, with versions,
licences and licence texts; and python/THIRD-PARTY-NOTICES.txt, the same for the wheel of the Python package. Run it when Cargo.lock changes: python3 scripts/third_party_notices.py

Where a crate offers the MIT licence it is taken under it; of the others all texts are given. Texts come from the sources of
the crates; a crate without a file has the text of its licence with its authors. tests/third_party.rs compares the list with
Cargo.lock.
"""

import json
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
# file -> the crates of the workspace that what it comes with is made of, and what that is called
NOTICES = {
    "THIRD-PARTY-NOTICES.txt": (["stickslip", "stickslip-fmu"], "Its shared and static libraries and its FMUs contain"),
    "python/THIRD-PARTY-NOTICES.txt": (
        ["stickslip", "stickslip-cli", "stickslip-fmu", "stickslip-python"],
        "The wheel of its Python package, with the command and the FMU library, contains",
    ),
}
MIT = """MIT License

Copyright (c) {holder}

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all
copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
SOFTWARE."""
HEAD = """Third-party notices
===================

stickslip itself is under the MIT licence (LICENSE). {what} compiled code of the
Rust standard library and of the crates below, some of them only on some platforms.

Made by scripts/third_party_notices.py from Cargo.lock.

Crates
------

"""


def cargo(*arguments):
    command = ["cargo", *arguments]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def linked(own):
    """Names and versions of the crates that are linked into what consists of the members `own`, on any platform."""
    members = [word for name in own for word in ("-p", name)]
    options = ["--locked", "--target", "all", "-e", "normal,no-proc-macro", "--prefix", "none", "-f", "{p}"]
    lines = cargo("tree", *members, "--features", "stickslip/capi", *options).splitlines()
    found = {tuple(line.split()[:2]) for line in lines if line.strip()}
    return {(name, version.removeprefix("v")) for name, version in found if name not in own}


def tidy(text):
    lines = [line.rstrip() for line in text.replace("\r\n", "\n").replace("\f", "").split("\n")]
    return "\n".join(lines).strip("\n")


def texts(package):
    """The licence texts of a crate."""
    folder = pathlib.Path(package["manifest_path"]).parent
    names = re.compile(r"(licen[cs]e|copying|notice|copyright|unlicense)", re.IGNORECASE)
    files = sorted(f for f in folder.iterdir() if f.is_file() and names.match(f.name))
    offers_mit = "MIT" in re.split(r"[ /()]+", package["license"])
    if offers_mit:
        # what is not the text of another alternative: the MIT text, and what the crate says of code that it took over
        others = re.compile(r"(apache|zlib|boost|unlicense|^copying$)", re.IGNORECASE)
        files = [f for f in files if not others.search(f.name)]
    found = [tidy(f.read_text(encoding="utf-8", errors="replace")) for f in files]
    if offers_mit and not any("Permission is hereby granted, free of charge" in text for text in found):
        authors = ", ".join(re.sub(r" *<.*?>", "", author) for author in package["authors"])
        found.insert(0, MIT.format(holder=authors or f"the authors of {package['name']}"))
    if not found:
        raise SystemExit(f"no licence text of {package['name']} {package['version']} ({package['license']})")
    return found


def write(file, own, what):
    wanted = linked(own)
    packages = json.loads(cargo("metadata", "--locked", "--format-version", "1"))["packages"]
    packages = [p for p in packages if (p["name"], p["version"]) in wanted]
    packages.sort(key=lambda p: (p["name"], p["version"]))
    if len(packages) != len(wanted):
        raise SystemExit("cargo metadata does not know all crates of cargo tree")
    head, by_text = HEAD.format(what=what), {MIT.format(holder="The Rust Project Contributors"): ["the Rust standard library"]}
    for package in packages:
        licence = package["license"].replace("/", " OR ")
        name = f"{package['name']} {package['version']}"
        head += f"{name} ({licence}) {package['repository'] or ''}".rstrip() + "\n"
        for text in texts(package):
            by_text.setdefault(text, []).append(name)
    body = "\nLicence texts\n-------------\n"
    for text, names in by_text.items():
        body += f"\n{'=' * 100}\nOf {', '.join(names)}:\n\n{text}\n"
    (ROOT / file).write_text(head + body, encoding="utf-8")
    print(f"{file}: {len(packages)} crates, {len(by_text)} texts")


def main():
    for file, (own, what) in NOTICES.items():
        write(file, own, what)


if __name__ == "__main__":
    main()
