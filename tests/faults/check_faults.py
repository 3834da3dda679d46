"""Injects the faults that a user meets, and looks at how the program ends.

    python check_faults.py PLIMSOLL

A fault must end the program within a minute, with a code other than 0 and one line on standard error that names what and
why: no panic, and no half file under the name of a whole one. What is no fault must not matter: odd paths, an unknown
locale, no home. Faults that need a file system of their own are mounted in a name space that ends with the process; where
that is not allowed they are skipped.
"""

import csv
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[2]
# Seconds that any run may take.
PATIENCE = 60.0
TANK = ["hydrostatic", "--set", "fluid.spacing=0.05", "--set", "fluid.threads=1"]
SHORT = ["--set", "run.end=0.05", "--set", "output.interval=0.01"]
LONG = ["--set", "run.end=60", "--set", "output.interval=0.02"]
# Blanks, letters outside ASCII and all that a URI must escape.
ODD = "Schiff über Öl 船 100%#1"


class Bench:
    """The program, a scratch folder, and what was found so far."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.counts = {"passed": 0, "failed": 0, "skipped": 0}
        self.fmus = folder / "fmus"
        self.number = 0

    def check(self, what, problems):
        """Takes one finding; it is good when there are no problems."""
        self.counts["failed" if problems else "passed"] += 1
        print(f"{'FAIL' if problems else 'ok  '} faults: {what}", *problems, sep="\n       ", flush=True)

    def skip(self, what, why):
        self.counts["skipped"] += 1
        print(f"skip faults: {what}: {why}", flush=True)

    def new(self, name):
        """The path of a folder that does not exist yet."""
        self.number += 1
        return self.folder / f"{self.number}-{name}"

    def command(self, *arguments, program=None):
        return [str(it) for it in (program or self.program, *arguments)]

    def run(self, *arguments, program=None, before=(), **options):
        """Runs the program to its end; `before` is a command that starts it."""
        options = {"cwd": ROOT, "stdin": subprocess.DEVNULL, "timeout": PATIENCE, **options}
        if not {"stdout", "stderr"} & set(options):
            options["capture_output"] = True
        command = [*before, *self.command(*arguments, program=program)]
        return subprocess.run(command, check=False, text=True, errors="replace", **options)

    def start(self, out, *arguments):
        """A run that goes on for a while, once it has written some rows."""
        command = self.command("run", *arguments, "--quiet", "--out", out)
        # Signals stay as they are in this process, which ignores SIGXFSZ: a limit on files is then an error to report.
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "restore_signals": False}
        process = subprocess.Popen(command, cwd=ROOT, errors="replace", **options)
        until = time.monotonic() + PATIENCE
        while len(lines_of(out / "results.csv")) < 10:
            if process.poll() is not None or time.monotonic() > until:
                process.kill()
                raise RuntimeError(f"the run did not start: {process.communicate()}")
            time.sleep(0.01)
        return process

    def case(self, name, fmu, **run):
        """A case with one structure, which swings without water."""
        path = self.folder / f"{name}.toml"
        numbers = {"end": 0.05, "communication_step": 0.001, **run}
        lines = ["[run]", *(f"{key} = {value}" for key, value in numbers.items())]
        lines += ["[[fmu]]", 'name = "plate"', f"path = {json.dumps(str(fmu), ensure_ascii=False)}"]
        lines += ["[fmu.parameters]", 'scene = "free_decay"']
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return path


class Ended:
    """How a process ended that was started in the background."""

    def __init__(self, process):
        try:
            self.stdout, self.stderr = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            self.stdout, self.stderr = process.communicate()
            self.stderr += "\nerror: killed after a timeout"
        self.returncode = process.returncode


def lines_of(path):
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        return []


def refused(done, *words):
    """What is wrong with the end of a faulty run; nothing, when it was refused with all these words."""
    found = [] if done.returncode in (1, 2) else [f"code {done.returncode}"]
    if "panicked" in done.stdout + done.stderr:
        found.append("a panic")
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    if len(errors) != 1:
        found.append(f"{len(errors)} lines of error")
    missing = [word for word in map(str, words) if not any(word in line for line in errors)]
    found += [f"no word of '{word}'" for word in missing]
    return found + [f"said: {done.stderr.strip()[-600:]}"] if found else []


def good(done, out=None):
    """What is wrong with a run that should have succeeded, and with its files."""
    # 3: at its end, but outside a limit of the scene, as coarse and short runs are.
    found = [] if done.returncode in (0, 3) else [f"code {done.returncode}: {done.stderr.strip()[-600:]}"]
    if "panicked" in f"{done.stdout}{done.stderr}":
        found.append(f"a panic: {done.stderr}")
    return found + (torn(out) + ended_as(out, "complete") + rows(out) if out else [])


def ended_as(out, status):
    try:
        found = json.loads((out / "summary.json").read_text(encoding="utf-8"))["status"]
    except (OSError, ValueError, KeyError) as error:
        return [f"summary.json: {error!r}"]
    return [] if found == status else [f"status {found}"]


def rows(out, last_may_be_torn=False):
    """Whether results.csv has whole rows of finite numbers, written with a point."""
    if not (out / "results.csv").is_file():
        return ["results.csv: missing"]
    text = (out / "results.csv").read_text(encoding="utf-8")
    table = list(csv.reader(text.splitlines()))
    whole = table[1:-1] if last_may_be_torn else table[1:]
    found = [] if text.endswith("\n") or last_may_be_torn else ["results.csv: the last row is torn"]
    if not whole:
        found.append("results.csv: no rows")
    for number, row in enumerate(whole, 2):
        numeric = all(re.fullmatch(r"-?\d+(\.\d+)?(e-?\d+)?", entry) for entry in row)
        if len(row) != len(table[0]) or not numeric:
            found.append(f"results.csv, line {number}: {len(row)} entries of {len(table[0])}, {row[:3]}")
    return found


# How a whole file of each kind ends.
ENDINGS = {".png": b"IEND\xaeB`\x82", ".svg": b"</svg>", ".html": b"</html>"}
ENDINGS |= {".vtu": b"</VTKFile>", ".pvd": b"</VTKFile>"}


def torn(folder, parts=False):
    """Files that are not what their names say; files with a name for work in progress count unless `parts`."""
    found = []
    for path in sorted(it for it in folder.rglob("*") if it.is_file()):
        content = path.read_bytes()
        if not content.rstrip().endswith(ENDINGS.get(path.suffix, b"")):
            found.append(f"{path.name} is torn after {len(content)} bytes")
        elif path.suffix in (".vtu", ".pvd"):
            root = ElementTree.fromstring(content)
            listed = [path.parent / entry.get("file") for entry in root.iter("DataSet")]
            found += [f"{path.name} lists {file.name}, which is missing" for file in listed if not file.is_file()]
        elif path.suffix == ".part" and not parts:
            found.append(f"{path.name} was left behind")
    try:
        json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except FileNotFoundError:
        pass
    except ValueError as error:
        found.append(f"summary.json: {error}")
    return found


def with_mounts(script):
    """A command that runs its arguments in a name space of their own, after these mounts; none, where not allowed."""
    for enter in (["unshare", "--mount"], ["unshare", "--map-root-user", "--mount"]):
        probe = [*enter, "sh", "-c", "mount -t tmpfs none /mnt"]
        if shutil.which("unshare") and subprocess.run(probe, check=False, capture_output=True).returncode == 0:
            return [*enter, "sh", "-c", script]
    return None


def full_disks(bench):
    """A disk of some size; what is on it afterwards is copied out."""
    mount = 'size=$1; disk=$2; copy=$3; shift 3; mount -t tmpfs -o "size=$size" none "$disk" || exit 99; '
    enter = with_mounts(mount + '"$@"; code=$?; cp -r "$disk" "$copy"; exit $code')
    # From one that takes a few rows to one that takes all but the page at the end.
    for size in ("16k", "64k", "300k", "2m"):
        what = f"a disk of {size} is full"
        if enter is None:
            bench.skip(what, "no mounts")
            continue
        disk, copy = bench.new("disk"), bench.new("copy")
        disk.mkdir()
        before = [*enter, "sh", size, str(disk), str(copy)]
        done = bench.run("run", *TANK, *SHORT, "--quiet", "--out", disk / "out", before=before)
        bench.check(what, refused(done, disk, "No space left") + torn(copy / "out"))


def enlarged_disks(bench):
    """A disk that was full is enlarged: the run goes on there, to the same results."""
    mount = 'size=$1; disk=$2; copy=$3; shift 3; mount -t tmpfs -o "size=$size" none "$disk" || exit 99; '
    twice = '"$@"; echo "first code $?"; mount -o remount,size=300m "$disk" || exit 98; "$@"; code=$?; '
    enter = with_mounts(mount + twice + 'cp -r "$disk" "$copy"; exit $code')
    tank = [*TANK, "--set", "run.end=6", "--set", "output.interval=0.02", "--set", "output.checkpoint_interval=0.02"]
    whole = bench.new("whole")
    bench.run("run", *tank, "--quiet", "--out", whole)
    for size in ("500k", "2m", "5m"):
        what = f"a disk of {size} is full, and then enlarged"
        if enter is None:
            bench.skip(what, "no mounts")
            continue
        disk, copy = bench.new("disk"), bench.new("copy")
        disk.mkdir()
        before = [*enter, "sh", size, str(disk), str(copy)]
        done = bench.run("run", *tank, "--resume", "--quiet", "--out", disk / "out", before=before)
        full = [] if "first code 1" in done.stdout else [f"it was not full: {done.stdout}"]
        bench.check(what, full + good(done, copy / "out") + differing(copy / "out", whole))


def limited_files(bench):
    out = bench.new("limited")
    process = bench.start(out, *TANK, *LONG)
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (16384, 16384))
    done = Ended(process)
    problems = refused(done, out, "File too large") + ended_as(out, "failed") + rows(out)
    bench.check("files may not grow any more", problems + torn(out))


def removed_folders(bench):
    for name, folder in (("results", ""), ("frames", "frames")):
        out = bench.new(name)
        process = bench.start(out, *TANK, *LONG)
        while (out / folder).exists():
            shutil.rmtree(out / folder, ignore_errors=True)
        bench.check(f"folder of {name} removed during the run", refused(Ended(process), out, "No such file"))
    bench.check("a run without its frames has whole rows and says so", ended_as(out, "failed") + rows(out) + torn(out))


def unwritable_results(bench):
    case = bench.case("plain", bench.fmus / "structure.fmu")
    file = bench.folder / "a file"
    file.write_text("kept")
    done = bench.run("run", case, "--out", file)
    kept = [] if file.read_text() == "kept" else ["the file is gone"]
    bench.check("a file in the place of the results", refused(done, file) + kept)
    done = bench.run("run", case, "--out", file / "below")
    bench.check("a file above the results", refused(done, file / "below"))
    out = bench.folder / ("n" * 300)
    bench.check("a name that is too long", refused(bench.run("run", case, "--out", out), out, "too long"))
    out = bench.folder / "/".join(["m" * 200] * 25)
    bench.check("a path that is too long", refused(bench.run("run", case, "--out", out), "too long"))
    for name in ("log.txt", "results.csv", "summary.json", "report.html"):
        out = bench.new("taken")
        (out / name).mkdir(parents=True)
        done = bench.run("run", case, "--out", out)
        bench.check(f"a folder in the place of {name}", refused(done, out / name, "a directory that no run wrote"))
    out = bench.new("thesis")
    out.mkdir()
    (out / "results.csv").write_text("mine")
    done = bench.run("run", case, "--overwrite", "--out", out)
    kept = [] if (out / "results.csv").read_text() == "mine" else ["the file is gone"]
    bench.check("a file of somebody else among the results", refused(done, out / "results.csv", "no run wrote") + kept)
    for folder, word in (("/", "the root"), (bench.folder.parent, "above the working directory")):
        done = bench.run("run", case, "--out", folder, cwd=bench.folder)
        bench.check(f"results into {word}", refused(done, folder, word))
    out = bench.new("read-only")
    out.mkdir()
    enter = with_mounts('mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" || exit 99; shift; "$@"')
    if enter is None:
        bench.skip("results on a read-only disk", "no mounts")
        return
    done = bench.run("run", case, "--out", out / "run", before=[*enter, "sh", str(out)])
    bench.check("results on a read-only disk", refused(done, out / "run", "Read-only"))
    done = bench.run("pack", "--out", out / "fmus", before=[*enter, "sh", str(out)])
    bench.check("FMUs onto a read-only disk", refused(done, out / "fmus", "Read-only"))


def changed_scenes(bench):
    for what, change in (("removed", Path.unlink), ("overwritten", lambda path: path.write_text("no scene = ["))):
        scene, out = bench.folder / f"{what}.toml", bench.new(what)
        shutil.copy(ROOT / "scenes" / "hydrostatic.toml", scene)
        process = bench.start(out, scene, *TANK[1:], "--set", "run.end=2", "--set", "output.interval=0.5")
        change(scene)
        bench.check(f"scene {what} after the start", good(Ended(process), out))
    done = bench.run("run", bench.folder / "overwritten.toml", "--out", bench.new("broken"))
    bench.check("a broken scene", refused(done, "overwritten.toml", "line 1"))
    done = bench.run("run", bench.folder / "removed.toml", "--out", bench.new("removed"))
    bench.check("no such scene", refused(done, "removed.toml", "neither a file nor a scene"))
    done = bench.run("run", bench.folder, "--out", bench.new("folder"))
    bench.check("a folder for a scene", refused(done, bench.folder))


def altered(source, target, change):
    """Copies an archive; `change` gives the new content of an entry, or nothing to leave it out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as new:
        for name in old.namelist():
            content = change(name, old.read(name))
            if content is not None:
                new.writestr(name, content)


def mathematics():
    """The C library's shared library of functions: loads anywhere, and is no FMU."""
    folders = ("/lib/x86_64-linux-gnu", "/usr/lib64", "/lib64", "/usr/lib", "/lib/aarch64-linux-gnu")
    return next((Path(it) / "libm.so.6" for it in folders if (Path(it) / "libm.so.6").is_file()), None)


def broken_binaries(binary):
    """Contents in the place of the shared library, each with what must be said of it."""
    other = binary[:18] + b"\x02\x00" + binary[20:]  # e_machine: SPARC
    broken = {"text": (b"no library", "shared library"), "empty": (b"", "shared library")}
    broken["another machine"] = (other, "cannot open shared object file")
    # Halves of a library load, and end the process by a signal, unless somebody looks before.
    broken["cut in half"] = (binary[: len(binary) // 2], "shared library")
    if mathematics():
        broken["no FMU"] = (mathematics().read_bytes(), "fmi2GetVersion")
    return broken


def special_files(bench):
    """Pipes and devices in the place of files would be read for ever."""
    pipe = bench.folder / "pipe.toml"
    os.mkfifo(pipe)
    done = bench.run("run", pipe, "--out", bench.new("pipe"))
    bench.check("a pipe for a scene", refused(done, pipe, "named pipe"))
    done = bench.run("run", "/dev/zero", "--out", bench.new("device"))
    bench.check("a device for a scene", refused(done, "/dev/zero", "device"))
    done = bench.run("run", bench.case("pipe-fmu", pipe), "--out", bench.new("pipe"))
    bench.check("a pipe for an FMU", refused(done, pipe, "named pipe"))
    check = "\n[[check]]\nname = 'c'\nkind = 'curve_rms'\nvariable = 'plate.body.base.plate.deflection.tip'\n"
    for what, file, word in (
        ("a pipe for a reference", "reference.csv", "named pipe"),
        ("a reference outside", "/etc/passwd", "lies outside the scene's folder"),
    ):
        case = bench.case("reference", bench.fmus / "structure.fmu")
        case.write_text(case.read_text() + check + f"file = '{file}'\ncolumns = ['t', 'v']\n")
        if not (bench.folder / "reference.csv").exists():
            os.mkfifo(bench.folder / "reference.csv")
        done = bench.run("run", case, "--out", bench.new("reference"))
        bench.check(what, refused(done, file, word))
    case.write_text(case.read_text() + "file_outside = true\n")
    out = bench.new("allowed")
    done = bench.run("run", case, "--out", out)
    told = f"{done.stdout}{done.stderr}" + "".join(
        path.read_text(errors="replace") for path in (out / "summary.json", out / "report.html", out / "summary.md")
    )
    leaks = [line for line in lines_of(Path("/etc/passwd")) if line in told]
    bench.check("what stands in a reference is never said", good(done, out) + leaks)


def broken_fmus(bench):
    whole = bench.fmus / "structure.fmu"
    library = "binaries/linux64/"

    def refuse(what, fmu, *words):
        done = bench.run("run", bench.case("broken", fmu), "--out", bench.new("broken"))
        bench.check(f"FMU: {what}", refused(done, fmu, *words))

    def change(what, entry, content, *words):
        fmu = bench.folder / f"{what}.fmu"
        altered(whole, fmu, lambda name, old: content(old) if name.startswith(entry) else old)
        refuse(what, fmu, *words)

    missing, text, cut = (bench.folder / f"{name}.fmu" for name in ("missing", "text", "cut"))
    text.write_text("no archive")
    cut.write_bytes(whole.read_bytes()[:100_000])
    refuse("missing", missing, "there is no such file")
    refuse("not an archive", text, "cannot unpack")
    refuse("cut off", cut, "cannot unpack")
    change("no description", "modelDescription", lambda _: None, "modelDescription.xml")
    change("half a description", "modelDescription", lambda old: old[:5000], "modelDescription.xml")
    change("FMI 3", "modelDescription", lambda old: old.replace(b'"2.0"', b'"3.0"'), "fmiVersion", "3.0")
    guid = lambda old: re.sub(rb'guid="[^"]*"', b'guid="{0}"', old)
    for name in ("../structure", "/usr/lib/libm", "a/b"):
        other = lambda old, name=name: re.sub(rb'modelIdentifier="[^"]*"', b'modelIdentifier="%s"' % name.encode(), old)
        change(f"modelIdentifier {name.replace('/', '-')}", "modelDescription", other, "modelIdentifier", name)
    bomb = bench.folder / "bomb.fmu"
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("resources/zeros", "w") as entry:
            for _ in range(100):
                entry.write(bytes(1 << 20))
    refuse("100 MB in 100 kB", bomb, "limits.unpacked_ratio = 200")
    change("another GUID", "modelDescription", guid, "{0}")
    change("no binaries", library, lambda _: None, "no binaries")
    with zipfile.ZipFile(whole) as archive:
        (name,) = [it for it in archive.namelist() if it.startswith(library)]
        binary = archive.read(name)
    for what, (content, word) in broken_binaries(binary).items():
        change(f"binary: {what}", library, lambda _, content=content: content, word)
    bits = bytearray(whole.read_bytes())
    bits[len(bits) // 2] ^= 0xFF
    flipped = bench.folder / "flipped.fmu"
    flipped.write_bytes(bits)
    refuse("a byte flipped", flipped, "cannot unpack")


def copied_program(bench, folder):
    """The program with its shared libraries in another folder, as an installation may put it."""
    folder.mkdir(parents=True)
    home = bench.program.parent
    for name in ("libfluid_fmu.so", "libstructure_fmu.so"):
        source = home / "deps" / name
        shutil.copy(source if source.is_file() else home / name, folder)
    return Path(shutil.copy(bench.program, folder))


def installed_programs(bench):
    program = copied_program(bench, bench.folder / "installed")
    enter = with_mounts('mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" || exit 99; shift; "$@"')
    what = "a read-only program folder without FMUs"
    if enter is None:
        bench.skip(what, "no mounts")
    else:
        out, temporary = bench.new("from-read-only"), bench.new("temporary")
        temporary.mkdir()
        environment = {**os.environ, "TMPDIR": str(temporary)}
        before = [*enter, "sh", str(program.parent)]
        done = bench.run("run", *TANK, *SHORT, "--out", out, program=program, before=before, env=environment)
        bench.check(what, good(done, out))
    alone = bench.folder / "alone" / "plimsoll"
    alone.parent.mkdir()
    shutil.copy(bench.program, alone)
    done = bench.run("run", "free_decay", "--out", bench.new("alone"), program=alone)
    bench.check("a program without its libraries", refused(done, "fluid_fmu", alone.parent))
    done = bench.run("run", "free_decay", "--out", bench.new("no-scenes"), program=program, cwd="/")
    bench.check("no scenes anywhere", refused(done, "scenes"))


def odd_paths(bench):
    odd = bench.folder / ODD
    program = copied_program(bench, odd / "Programm für Öl")
    temporary = odd / "temporär 船"
    temporary.mkdir()
    shutil.copytree(ROOT / "scenes", odd / "scenes")
    scene = odd / "Ölstand 100 %.toml"
    shutil.copy(ROOT / "scenes" / "dam_break_plate.toml", scene)
    environment = {**os.environ, "TMPDIR": str(temporary)}
    coarse = ["--set", "fluid.spacing=0.02", "--set", "run.end=0.01", "--set", "output.interval=0.005"]
    out = odd / "Ergebnis für später 船"
    for locale in ("C", "de_DE.UTF-8"):
        environment["LC_ALL"] = locale
        done = bench.run("run", scene, *coarse, "--overwrite", "--out", out, program=program, cwd=odd, env=environment)
        problems = good(done, out)
        frames = sorted(path.name for path in (out / "frames").glob("*.pvd"))
        problems += [] if frames == ["particles.pvd", "structure.pvd"] else [f"frames: {frames}"]
        bench.check(f"odd paths everywhere, locale {locale}", problems)
    # A name that is no text: texts are all that an FMU takes, so that it cannot be handed on.
    out = Path(os.fsdecode(os.fsencode(bench.folder) + b"/\xff"))
    done = bench.run("run", *TANK, *SHORT, "--quiet", "--out", out)
    elsewhere = [] if (out / "frames" / "particles.pvd").is_file() else ["its frames are elsewhere"]
    bench.check("a path that is not UTF-8", refused(done, "UTF-8") if done.returncode else elsewhere)
    fmu = shutil.copy(bench.fmus / "structure.fmu", odd / "Platte über Öl.fmu")
    for path in (Path(fmu), Path(ODD) / "Platte über Öl.fmu"):
        out = bench.new("odd-case")
        done = bench.run("run", bench.case("odd", path), "--out", out, env=environment)
        bench.check(f"an odd path of an FMU, {'absolute' if path.is_absolute() else 'relative'}", good(done, out))
    left = list(temporary.iterdir())
    bench.check("nothing is left in the temporary folder", [f"left: {left}"] if left else [])


def environments(bench):
    case = bench.case("environment", bench.fmus / "structure.fmu")
    tables = []
    settings = [{"LC_ALL": "xx_YY.bad"}, {"LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}, {"LC_ALL": "C"}]
    settings += [{"TERM": None}, {"TERM": "dumb"}, {"HOME": None}, {"HOME": "/nowhere"}, {"PATH": None}]
    for setting in settings:
        merged = {**os.environ, **setting}
        environment = {key: value for key, value in merged.items() if value is not None}
        out = bench.new("environment")
        done = bench.run("run", case, "--out", out, env=environment)
        bench.check(f"environment {setting}", good(done, out))
        tables.append("\n".join(lines_of(out / "results.csv")))
    bench.check("the same results in each environment", [] if len(set(tables)) == 1 else ["they differ"])


def temporary_folders(bench):
    case = bench.case("temporary", bench.fmus / "structure.fmu")
    file = bench.folder / "no-folder"
    file.write_text("")
    for what, path in (("missing", bench.folder / "nowhere"), ("a file", file)):
        done = bench.run("run", case, "--out", bench.new("temporary"), env={**os.environ, "TMPDIR": str(path)})
        bench.check(f"a temporary folder that is {what}", refused(done, path))
    folder = bench.new("small")
    folder.mkdir()
    enter = with_mounts('mount -t tmpfs -o "$1" none "$2" || exit 99; shift 2; "$@"')
    for what, option, word in (("full", "size=64k", "No space left"), ("read-only", "ro", "Read-only")):
        if enter is None:
            bench.skip(f"a temporary folder that is {what}", "no mounts")
            continue
        environment = {**os.environ, "TMPDIR": str(folder)}
        before = [*enter, "sh", option, str(folder)]
        done = bench.run("run", case, "--out", bench.new("temporary"), env=environment, before=before)
        bench.check(f"a temporary folder that is {what}", refused(done, "structure.fmu", word))


def broken_pipe():
    """The writing end of a pipe that nobody reads."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def without_panic(done, *codes):
    """Rust's code for a panic is 101; what a panic says may be lost with the stream."""
    found = [] if done.returncode in codes else [f"code {done.returncode}, expected {codes}"]
    return found + (["a panic"] if "panicked" in f"{done.stdout}{done.stderr}" else [])


def streams(bench):
    gone = -signal.SIGPIPE
    for arguments in (["list-scenes"], ["check", "damaged_cabin"], ["--help"], ["compare", "--help"]):
        writer = broken_pipe()
        done = bench.run(*arguments, stdout=writer, stderr=subprocess.PIPE)
        os.close(writer)
        bench.check(f"nobody reads `{' '.join(arguments)}`", without_panic(done, 0, 1, gone))
    case = bench.case("streams", bench.fmus / "structure.fmu")
    for what, names in (("output", ["stdout"]), ("errors", ["stderr"]), ("output and errors", ["stdout", "stderr"])):
        writer, out = broken_pipe(), bench.new("unread")
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **dict.fromkeys(names, writer)}
        done = bench.run("run", case, "--out", out, **options)
        os.close(writer)
        problems = without_panic(done, 0, 1) + ended_as(out, "complete") + rows(out)
        bench.check(f"nobody reads the {what} of a run", problems)
    out = bench.new("closed")
    done = bench.run("run", case, "--out", out, before=["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh"])
    bench.check("a run with all streams closed", good(done, out))
    with open("/dev/full", "w") as full:
        done = bench.run("list-scenes", stdout=full, stderr=subprocess.PIPE)
        bench.check("a full disk behind the output", without_panic(done, 1))
        done = bench.run("run", "no-such-scene", stdout=subprocess.PIPE, stderr=full)
        bench.check("a full disk behind the errors", without_panic(done, 1))


def signals(bench):
    for name, codes in (("SIGINT", [130]), ("SIGTERM", [130, 143])):
        out = bench.new(name)
        process = bench.start(out, *TANK, *LONG)
        process.send_signal(signal.Signals[name])
        done = Ended(process)
        problems = without_panic(done, *codes) + ended_as(out, "interrupted") + rows(out) + torn(out)
        bench.check(f"{name} in the middle", problems)
    out = bench.new("SIGKILL")
    process = bench.start(out, *TANK, *LONG)
    process.kill()
    done = Ended(process)
    # Only a file with a name for work in progress may be torn.
    problems = without_panic(done, -signal.SIGKILL) + rows(out, last_may_be_torn=True) + torn(out, parts=True)
    bench.check("SIGKILL in the middle", problems)
    done = bench.run("run", *TANK, *SHORT, "--quiet", "--out", out)
    said = [] if "was cut off before its end" in done.stderr else ["it is not said that the run before was cut off"]
    bench.check("the next run into the same folder", good(done, out) + said)
    done = bench.run("run", *TANK, *SHORT, "--quiet", "--out", out)
    bench.check("and another one", refused(done, out, "holds a complete run") + rows(out))
    out = bench.new("two")
    process = bench.start(out, *TANK, *LONG)
    done = bench.run("run", *TANK, *SHORT, "--overwrite", "--quiet", "--out", out)
    bench.check("a second run into a folder at work", refused(done, out, f"process {process.pid}"))
    process.send_signal(signal.SIGINT)
    bench.check("and the first goes on", without_panic(Ended(process), 130) + rows(out))


def killed(bench, *arguments):
    """The folder of a run that was killed after it wrote a checkpoint."""
    out = bench.new("killed")
    process = bench.start(out, *arguments)
    until = time.monotonic() + PATIENCE
    while not (out / "checkpoint.bin").is_file() and process.poll() is None and time.monotonic() < until:
        time.sleep(0.01)
    process.kill()
    Ended(process)
    return out


def differing(one, other):
    """Tables and lists of frames in which two runs differ."""
    names = ["results.csv", "iterations.csv", "frames/particles.pvd"]
    return [f"{name} differs" for name in names if lines_of(one / name) != lines_of(other / name)]


def resumed_runs(bench):
    if "--resume" not in bench.run("run", "--help").stdout:
        bench.skip("runs go on after a kill", "the program writes no checkpoints")
        return
    tank = [*TANK, "--set", "run.end=6", "--set", "output.interval=0.1", "--set", "output.checkpoint_interval=0.02"]
    whole, out = bench.new("whole"), killed(bench, *tank)
    bench.run("run", *tank, "--quiet", "--out", whole)
    kept = bench.new("kept")
    shutil.copytree(out, kept)
    done = bench.run("run", *tank, "--resume", "--quiet", "--out", out)
    bench.check("a run goes on after a kill as if nothing had been", good(done, out) + differing(out, whole))

    def refuse(what, name, change, *words, extra=()):
        # In its own place: the folder is among what a run is made of.
        shutil.rmtree(out)
        shutil.copytree(kept, out)
        change(out / name)
        done = bench.run("run", *tank, *extra, "--resume", "--quiet", "--out", out)
        bench.check(f"resumed with {what}", refused(done, out / name, *words))

    def flip(path):
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content)

    refuse("a byte of the checkpoint flipped", "checkpoint.bin", flip, "damaged")
    refuse("half a checkpoint", "checkpoint.bin", lambda path: os.truncate(path, path.stat().st_size // 2), "a truncated checkpoint")
    refuse("an empty checkpoint", "checkpoint.bin", lambda path: os.truncate(path, 0), "a truncated checkpoint: 0 bytes")
    refuse("half the results", "results.csv", lambda path: os.truncate(path, path.stat().st_size // 4), "bytes")
    refuse("no results", "results.csv", Path.unlink, "No such file")
    denser = ["--set", "fluid.density=1025"]
    refuse("another density", "checkpoint.bin", lambda path: None, "other inputs", extra=denser)
    taken = bench.new("taken")
    # Long enough for a checkpoint to be due, and late enough for its place to be taken first.
    often = ["--set", "run.end=40", "--set", "output.checkpoint_interval=0.5"]
    process = bench.start(taken, *TANK, *often)
    (taken / "checkpoint.bin").mkdir()
    done = Ended(process)
    said = [] if "no checkpoint" in done.stderr else ["it is not said"]
    bench.check("a run goes on when its checkpoint cannot be written", good(done, taken) + said)


FAULTS = [
    full_disks,
    enlarged_disks,
    limited_files,
    removed_folders,
    unwritable_results,
    changed_scenes,
    special_files,
    broken_fmus,
    installed_programs,
    odd_paths,
    environments,
    temporary_folders,
    streams,
    signals,
    resumed_runs,
]


def main():
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as temporary:
        bench = Bench(Path(sys.argv[1]).resolve(), Path(temporary).resolve())
        bench.check("the FMUs are packed", good(bench.run("pack", "--out", bench.fmus)))
        chosen = sys.argv[2:] or [fault.__name__ for fault in FAULTS]
        for fault in (fault for fault in FAULTS if fault.__name__ in chosen):
            try:
                fault(bench)
            except (OSError, RuntimeError, subprocess.TimeoutExpired) as error:
                bench.check(fault.__name__, [repr(error)])
    counts = ", ".join(f"{count} {how}" for how, count in bench.counts.items())
    print(f"faults: {time.monotonic() - begin:.0f} s")
    print(counts)
    sys.exit(1 if bench.counts["failed"] else 0)


if __name__ == "__main__":
    main()
