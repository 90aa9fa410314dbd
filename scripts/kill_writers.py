#!/usr/bin/env python3
"""Kills programs while they write, and looks at what they leave behind.

On a small simulated drive, each program that writes files is run over older results and killed at a random moment by
SIGINT, SIGTERM or SIGKILL. Afterwards the results must be the old ones or the new ones, whole. After SIGINT and SIGTERM
nothing else may be there, and the program must have ended by the signal; after SIGKILL temporary files may be, which go
when the program is run once more. Prints a table; exit code 1 where anything else was found.

    scripts/kill_writers.py                                # 60 kills of each program
    scripts/kill_writers.py -kills 10 -programs build_map,localize

An update in place is compared by what `saw_ndt_map_merge` makes of the file: bytes behind its end mean nothing.
"""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)


def is_temporary(path):
    return any(".tmp-" in part or part.startswith(".saw_ndt") for part in path.parts)


def files_in(folder):
    """Contents by names of what is in a folder, temporary files apart; folders are None."""
    files, temporary = {}, []
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder)
        if is_temporary(name):
            temporary.append(str(name))
        else:
            files[str(name)] = path.read_bytes() if path.is_file() else None
    return files, temporary


class Programs:
    """Calls the programs in a folder."""

    def __init__(self, build):
        self.folder = build / "apps"

    def path(self, name):
        return str(self.folder / f"saw_ndt_{name}")

    def has(self, name):
        return (self.folder / f"saw_ndt_{name}").exists()

    def run(self, folder, *words):
        command = [self.path(words[0]), *words[1:]]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit code {done.returncode}: {done.stderr}")


class Inputs:
    """Drives, maps and runs that the programs work on, and older results. Each is made when it is first asked for."""

    POSES = ["drive2/poses.txt", "run/trajectory_kitti.txt", "-times", "drive2/times.txt", "-calib", "drive2/calib.txt",
             "-skip", "0"]
    # Maps merge where scans were segmented in the same way, or not at all.
    RECIPES = {
        "drive1": ["simulate", "drive1", "-scene", "rural", "-sensor", "VLP-16", "-scans", "{scans}"],
        "drive2": ["simulate", "drive2", "-scene", "rural", "-sensor", "VLP-16", "-drive", "2", "-scans", "{scans}"],
        "one.map": ["build_map", "drive1", "one.map"],
        "two.map": ["build_map", "drive2", "two.map"],
        "coarse.map": ["build_map", "drive1", "coarse.map", "-resolution", "1"],
        "classical1.map": ["build_map", "drive1", "classical1.map", "-classical"],
        "classical2.map": ["build_map", "drive2", "classical2.map", "-classical"],
        "one.loc": ["map_pack", "one.map", "one.loc"],
        "cloud.pcd": ["map_info", "one.map", "-pcd", "cloud.pcd"],
        "old.pcd": ["map_info", "coarse.map", "-pcd", "old.pcd"],
        "old.png": ["map_info", "coarse.map", "-picture", "old.png"],
        "run": ["localize", "drive2", "one.loc", "run", "-skip", "0"],
        "old_run": ["localize", "drive2", "one.loc", "old_run", "-skip", "0", "-scans", "0:4"],
        "old_plots": ["evaluate", *POSES, "-align", "yaw", "-plot", "old_plots"],
        "old_benchmark": ["benchmark", "drive2", "-output", "old_benchmark", "-skip", "0", "-methods", "classical",
                          "-scans", "0:4"],
    }

    def __init__(self, programs, folder, scans):
        self.programs, self.folder, self.scans = programs, folder, scans
        folder.mkdir()

    def path(self, name):
        """Of an input or of something in it."""
        first = name.split("/")[0]
        if not (self.folder / first).exists():
            words = [word.format(scans=self.scans) for word in self.RECIPES[first]]
            for word in words[1:]:
                if word != first and word.split("/")[0] in self.RECIPES:
                    self.path(word)
            self.programs.run(self.folder, *words)
        return self.folder / name


class Case:
    """A program and how it is called: words that begin with @ are inputs. `old` is an input that is in the way of its
    output, the first word `out`. `canonical` makes of a map what is compared. `separate`: its results are written one
    after the other, each for itself."""

    def __init__(self, name, words, old=None, output="out", launcher=(), canonical=None, separate=False):
        self.name, self.words, self.old, self.output = name, words, old, output
        self.launcher, self.canonical, self.separate = list(launcher), canonical, separate

    def command(self, programs, inputs):
        words = [str(inputs.path(word[1:])) if word.startswith("@") else word for word in self.words[1:]]
        return [*self.launcher, programs.path(self.words[0]), *words]

    def put_old(self, inputs, folder):
        if self.old:
            source = inputs.path(self.old)
            (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / self.output)


def all_cases(programs):
    poses = ["@" + word if "/" in word else word for word in Inputs.POSES]
    cases = [
        Case("build_map", ["build_map", "@drive1", "out"], "coarse.map"),
        Case("build_map, new", ["build_map", "@drive1", "out"]),
        Case("localize", ["localize", "@drive2", "@one.loc", "out", "-skip", "0"], "old_run"),
        Case("localize, new", ["localize", "@drive2", "@one.loc", "out/a", "-skip", "0"]),
        Case("segment", ["segment", "@drive1/velodyne/000000.bin", "out"], "old.pcd"),
        Case("simulate", ["simulate", "out", "-scene", "rural", "-sensor", "VLP-16", "-scans", "8"]),
        Case("benchmark", ["benchmark", "@drive2", "-output", "out", "-skip", "0", "-methods", "classical"],
             "old_benchmark"),
        Case("map_pack", ["map_pack", "@one.map", "out"], "coarse.map"),
        Case("map_merge", ["map_merge", "out", "@classical1.map", "@classical2.map"], "coarse.map"),
        Case("map_merge -update", ["map_merge", "-update", "out", "@classical2.map"], "classical1.map",
             canonical=["map_merge", "canonical", "out"]),
        Case("map_crop", ["map_crop", "@one.map", "out", "-box", "-20,-20,20,20"], "coarse.map"),
        Case("map_import", ["map_import", "@cloud.pcd", "out"], "coarse.map"),
        Case("map_remove_moved", ["map_remove_moved", "@one.map", "out", "@drive1"], "coarse.map"),
        Case("map_diff", ["map_diff", "@one.map", "@two.map", "-pcd", "out", "-picture", "out.png"], "old.pcd",
             separate=True),
        Case("map_info -picture", ["map_info", "@one.map", "-picture", "out.png"], "old.png", "out.png"),
        Case("map_info -pcd", ["map_info", "@one.map", "-pcd", "out"], "old.pcd"),
        Case("evaluate -plot", ["evaluate", *poses, "-plot", "out"], "old_plots"),
        Case("align", ["align", "@drive1/velodyne/000001.bin", "@drive1/velodyne/000000.bin", "out"], "old.pcd"),
    ]
    if programs.has("build_map_mpi") and shutil.which("mpirun"):
        cases.append(Case("build_map_mpi", ["build_map_mpi", "@drive1", "out"], "coarse.map",
                          launcher=["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"]))
    return cases


def wait_for_all_in(folder):
    """Until no process works in a folder any more, such as a rank whose launcher was killed."""
    for _ in range(200):
        busy = False
        for process in Path("/proc").iterdir():
            try:
                busy = busy or (process.name.isdigit() and os.readlink(process / "cwd") == str(folder))
            except OSError:
                pass
        if not busy:
            return
        time.sleep(0.05)


class Campaign:
    """Kills one program again and again."""

    def __init__(self, case, programs, inputs, folder):
        self.case, self.inputs, self.folder = case, inputs, folder
        self.command = case.command(programs, inputs)
        self.canonical = [programs.path(case.canonical[0]), *case.canonical[1:]] if case.canonical else None
        self.faults = []
        self.counts = {key: 0 for key in ("kills", "in_time", "old", "new", "left")}
        self.reset()
        self.old, _ = self.state()
        self.seconds = self.measure()
        self.new, _ = self.state()
        self.seconds = max(self.seconds, self.measure())
        again, _ = self.state()
        # What tells of times differs from run to run: it must be whole.
        self.varying = {name for name in self.new if self.new[name] != again.get(name)}

    def reset(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir()
        self.case.put_old(self.inputs, self.folder)

    def measure(self):
        self.reset()
        begin = time.monotonic()
        done = subprocess.run(self.command, cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{self.case.name}: exit code {done.returncode}: {done.stderr}")
        return time.monotonic() - begin

    def state(self):
        if self.canonical:
            subprocess.run(self.canonical, cwd=self.folder, capture_output=True, check=True)
            (self.folder / "canonical").replace(self.folder / "out")
        return files_in(self.folder)

    def is_whole(self, name, content):
        """Of a file that differs from run to run."""
        reference = self.new[name]
        if name.endswith(".json"):
            try:
                return json.loads(content).keys() == json.loads(reference).keys()
            except ValueError:
                return False
        if name.endswith(".csv"):
            return content.count(b"\n") == reference.count(b"\n") and content.endswith(b"\n")
        return content[-5:] == reference[-5:]

    def is_new(self, name, content):
        if name not in self.new:
            return name in self.old and content == self.old[name]  # a file of the older results that stays
        if name in self.varying and content is not None:
            return self.is_whole(name, content)
        return content == self.new[name]

    def verdict(self, files):
        if files == self.old:
            return "old"
        if files.keys() == self.new.keys() and all(self.is_new(name, files[name]) for name in files):
            return "new"
        return None

    def is_mixed(self, files):
        """Each file is an old or a new one: where several are moved, SIGKILL may come in between."""
        return all(files[name] == self.old.get(name, b"") or self.is_new(name, files[name]) for name in files)

    def kill(self, number, draw):
        self.reset()
        share = draw.uniform(0.0, 1.1) if number % 2 else draw.uniform(0.7, 1.05)
        which = SIGNALS[number % len(SIGNALS)]
        process = subprocess.Popen(self.command, cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        time.sleep(share * self.seconds)
        if which == signal.SIGKILL:
            os.killpg(process.pid, which)
        else:
            os.kill(process.pid, which)
        code = process.wait()
        wait_for_all_in(self.folder)
        self.look(which, code)

    def fault(self, which, what):
        self.faults.append(f"{self.case.name}, {which.name}: {what}")

    def look(self, which, code):
        self.counts["kills"] += 1
        self.counts["in_time"] += code != 0
        if code not in (0, -which, 128 + which) and not self.case.launcher:
            self.fault(which, f"exit code {code}")
        files, temporary = self.state()
        self.counts["left"] += bool(temporary)
        verdict = self.verdict(files)
        if verdict:
            self.counts[verdict] += 1
        elif not (self.case.separate or which == signal.SIGKILL) or not self.is_mixed(files):
            self.fault(which, f"neither the old results nor the new ones: {sorted(files)[:4]}")
        if temporary and which != signal.SIGKILL:
            self.fault(which, f"left behind: {temporary[:4]}")
        if which == signal.SIGKILL and self.case.name != "simulate":
            self.run_once_more(which)

    def run_once_more(self, which):
        done = subprocess.run(self.command, cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            return self.fault(which, f"run once more: {done.stderr}")
        if self.case.canonical:
            return None  # adds the same drive once more
        files, temporary = self.state()
        if temporary or self.verdict(files) != "new":
            self.fault(which, f"run once more it leaves {sorted(files)[:4]} and {temporary[:4]}")
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("-kills", type=int, default=60, help="of each program (60)")
    parser.add_argument("-scans", type=int, default=8, help="of the simulated drives (8)")
    parser.add_argument("-seed", type=int, default=1)
    parser.add_argument("-programs", default="", help="names as in the table, separated by commas; all unless given")
    parser.add_argument("-build", type=Path, default=Path(__file__).resolve().parent.parent / "build" / "release")
    arguments = parser.parse_args()
    draw = random.Random(arguments.seed)
    wanted = [name for name in arguments.programs.split(",") if name]
    faults = []
    with tempfile.TemporaryDirectory(prefix="saw_ndt_kills_") as name:
        work = Path(name).resolve()
        programs = Programs(arguments.build.resolve())
        inputs = Inputs(programs, work / "inputs", arguments.scans)
        print("| program | kills | before its end | old results | new results | temporary files left by SIGKILL |")
        print("|---|---|---|---|---|---|")
        for case in all_cases(programs):
            if wanted and case.name.split(",")[0].split()[0] not in wanted:
                continue
            campaign = Campaign(case, programs, inputs, work / "case")
            for number in range(arguments.kills):
                campaign.kill(number, draw)
            print(f"| {case.name} | " + " | ".join(str(count) for count in campaign.counts.values()) + " |", flush=True)
            for fault in campaign.faults:
                print(fault, file=sys.stderr, flush=True)
            faults += campaign.faults
    print(f"\n{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
