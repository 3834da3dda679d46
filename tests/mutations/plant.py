#!/usr/bin/env python3
"""Plants the faults of faults.toml one by one in a copy of the sources and runs the quick tests until one of them fails.

usage: python3 tests/mutations/plant.py [--only N,M] [--record FILE]

The copy, with its own build, is target/mutations. The tests of the crate with the fault come first, then the quick variants of
the scenes, then all other tests.
"""

import argparse
import datetime
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
COPY = ROOT / "target" / "mutations"
PACKAGES = {"master": "plimsoll"}


def run(command):
    return subprocess.run(command, cwd=COPY, capture_output=True, text=True)


def copy():
    """Files that differ only, so that what was built there stays."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in filter(None, listed.split("\0")):
        source, target = ROOT / name, COPY / name
        if not source.is_file() or target.is_file() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


def stages(file):
    parts = pathlib.Path(file).parts
    package = PACKAGES.get(parts[0], parts[1] if parts[0] == "crates" else parts[0])
    test = ["cargo", "test", "--release"]
    yield f"unit tests of {package}", test + ["-p", package, "--lib"]
    yield f"tests of {package}", test + ["-p", package]
    yield "quick variants of the scenes", test + ["-p", "plimsoll", "--test", "validate"]
    yield "all tests", test + ["--workspace"]


def finder(file):
    """The stage and the test that failed first; nothing if none did."""
    for name, command in stages(file):
        done = run(command)
        if done.returncode == 0:
            continue
        said = done.stdout + done.stderr
        if "could not compile" in said:
            return "the compiler", re.search(r"^error.*$", said, re.M).group(0)
        failed = re.findall(r"^test (\S+) \.\.\. FAILED$", said, re.M)
        return name, failed[0] if failed else "ended without a result"
    return None


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--only", help="numbers of faults, from 1, apart by commas")
    arguments.add_argument("--record", type=pathlib.Path, help="file for the table of what found them")
    options = arguments.parse_args()
    faults = tomllib.loads((ROOT / "tests/mutations/faults.toml").read_text())["fault"]
    chosen = {int(number) for number in options.only.split(",")} if options.only else set(range(1, len(faults) + 1))
    copy()
    rows, found = [], 0
    for number, fault in enumerate(faults, 1):
        if number not in chosen:
            continue
        path = COPY / fault["file"]
        sound = path.read_text()
        assert sound.count(fault["from"]) == 1, f"{fault['file']}: `{fault['from']}` stands there {sound.count(fault['from'])} times"
        path.write_text(sound.replace(fault["from"], fault["to"]))
        by = finder(fault["file"])
        path.write_text(sound)
        found += by is not None and by[0] != "the compiler"
        by = f"{by[0]}: `{by[1]}`" if by else "**not found**"
        print(f"{number:3} {fault['what']}: {by}", flush=True)
        rows.append(f"| {number} | {fault['what']} | `{fault['file']}` | {by} |\n")
    if options.record:
        date = datetime.date.today().isoformat()
        commit = subprocess.run(["git", "rev-parse", "--short=12", "HEAD"], cwd=ROOT, capture_output=True, text=True)
        head = f"# {date}: planted faults, and which test found them\n\n{found} of {len(rows)} found. Commit {commit.stdout.strip()}; "
        head += "`python3 tests/mutations/plant.py`.\n\n| | fault | file | found by |\n|---|---|---|---|\n"
        options.record.write_text(head + "".join(rows))
    print(f"{found} passed, {len(rows) - found} failed: faults found")
    sys.exit(0 if found == len(rows) else 1)


main()
