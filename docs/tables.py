"""Writes the tables of the documentation in place: python3 docs/tables.py [--check] [PROGRAM] [NAME …].

A table stands in a page between `<!-- table: NAME -->` and `<!-- end -->`. Those of the quick tier (docs/problems.py, docs/closed_forms.py, docs/choosing.py,
docs/limit_loads.py, docs/error_bars.py and others) come from runs of
seconds; with --check nothing is written, and the exit code is 1 where a number is not the committed one: texts must be equal (but for the cost of iterations),
numbers may differ by one in the last digit. Those that take longest are compared where they are named, and with --all. Those of the slow tier are printed by
commands of minutes:

    python3 docs/tables.py --slow NAME …           runs the command of each table and writes what it prints
    python3 docs/tables.py --slow NAME --from FILE what was printed before
    python3 docs/tables.py --list                  all names, with pages and commands

Needs numpy.
"""

import argparse
import itertools
import pathlib
import re
import subprocess
import sys

from cavities_and_walls import WALLS
from choosing import CHOOSING
from closed_forms import CLOSED
from error_bars import BARS, SLOW_BARS
from faults_and_water import SLOW_WATER, WATER
from forming import FORMING
from limit_loads import LIMIT
from paper import PAPER
from penalties import PENALTIES
from piles_in_clay import SLOW_PILES
from problems import COST, QUICK
from results import text_of
from shafts_and_columns import SHAFTS

ROOT = pathlib.Path(__file__).resolve().parent.parent
MARKED = re.compile(r"(<!-- table: (\S+) -->\n)(.*?)(\n<!-- end -->)", re.S)
NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
PUBLISHED = "cargo test --release --test published -- --ignored --nocapture "
CYCLES = """cargo run --release --example dipping_fault -- 60 1 100 800e3 320 out/bp3 && cargo run --release -- run out/bp3/bp3.json &&
    python3 docs/figures/surface.py out/bp3 docs/figures/bp3_surface.svg"""
FRONTS = PUBLISHED + "fronts_on_fine"
LABORATORY = """cargo run --release -- run cases/laboratory/fault_4m.json &&
    python3 docs/figures/laboratory.py out/fault_4m docs/figures/laboratory.svg"""
# Of the quick tier: the function that makes it.
TABLES = {**QUICK, **CLOSED, **CHOOSING, **LIMIT, **WALLS, **FORMING, **SHAFTS, **PENALTIES, **BARS, **WATER, **PAPER}
# Written, but not compared: iterations that do not converge hang on the last digit, which differs between processors.
LOOSE = {"cut_back", "drawing", "penalties"}
# Of ten seconds and more each, whose like is compared by a shorter table or by a test: compared where they are named, and with --all.
LONG = {
    "bars_of_yielding", "choosing_peak", "footing_in_a_box", "footing_on_cam_clay", "footing_on_soil", "footing_v_h", "injection", "partial_slip",
    "partial_slip_heals", "passive_wall", "pile", "pipe_in_clay",
}
# Of the slow tier: the command that prints it, and which of the tables that it prints.
SLOW = {
    "ironing": (PUBLISHED + "ironing", 0),
    "ablation": ("RAYON_NUM_THREADS=1 " + PUBLISHED + "ablation", 0),
    "neighbours": ("RAYON_NUM_THREADS=1 AIDS=predicted_pressure,stick_again,valley,downhill " + PUBLISHED + "neighbours", 0),
    "healing": (PUBLISHED + "answers_converge", 0),
    "tpv3": (PUBLISHED + "tpv3_breaks", 0),
    "tpv205": (PUBLISHED + "tpv205_breaks", 0),
    "tpv10": (PUBLISHED + "tpv10", 0),
    "tpv10_choices": (PUBLISHED + "what_arrivals", 0),
    "tpv14": (PUBLISHED + "tpv14", 0),
    "tpv15": (PUBLISHED + "tpv15", 0),
    "bp3_cycles": (PUBLISHED + "cycles_of_a_thrust", 0),
    "bp3_surface": (CYCLES, 0),
    "laboratory": (LABORATORY, 0),
    "laboratory_fronts": (LABORATORY, 1),
    "record_basalt": ("python3 cases/laboratory/velocity_step.py", 0),
    "record_sepiolite": ("python3 cases/laboratory/rising_step.py", 0),
    "record_pile": ("python3 cases/laboratory/pile_load_test.py docs/figures/pile_load_test.svg", 0),
    "fronts_weakening": (FRONTS, 0),
    "fronts_super_subloading": (FRONTS, 1),
    "weak_patch": (PUBLISHED + "weak_patch_converge", -1),
    "slip_front": (PUBLISHED + "some_fronts", 0),
    "front_force": (PUBLISHED + "the_force_falls", -1),
    "front_meshes": (PUBLISHED + "how_far", -1),
    "numerical_choices": (PUBLISHED + "answers_do", 0),
    "spring_mass_resolved": (PUBLISHED + "resolved_runs", 0),
    **{name: (f"python3 docs/error_bars.py target/release/fecontact {name}", 0) for name in SLOW_BARS},
    **{name: (f"python3 docs/piles_in_clay.py target/release/fecontact {name}", 0) for name in SLOW_PILES},
    **{name: (f"python3 docs/faults_and_water.py target/release/fecontact {name}", 0) for name in SLOW_WATER},
}


def marked():
    """Page, name and text of every marked table."""
    for page in sorted([*ROOT.glob("docs/**/*.md"), *ROOT.glob("cases/**/*.md")]):
        for found in MARKED.finditer(page.read_text()):
            yield page, found[2], found[3].strip()


def printed(text, which):
    """One of the tables in what a command has printed; a test that takes long is told of in between."""
    lines = (line.strip() for line in text.splitlines() if not line.endswith("has been running for over 60 seconds"))
    tables = ["\n".join(group) for is_row, group in itertools.groupby(lines, lambda line: line.startswith("|")) if is_row]
    if len(tables) <= which or not tables:
        sys.exit(f"{len(tables)} tables were printed, number {which + 1} was expected")
    return tables[which]


def unit(number):
    """One in the last digit of a number as it is written."""
    mantissa, _, power = number.partition("e")
    return 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))


def same(old, new):
    """Whether two lines say the same: equal texts, and numbers equal but for one in the last digit."""
    if NUMBER.sub("#", old) != NUMBER.sub("#", new):
        return False
    pairs = zip(NUMBER.findall(old), NUMBER.findall(new))
    return all(abs(float(a.replace("−", "-")) - float(b.replace("−", "-"))) < 1.5 * unit(a) for a, b in pairs)


def compared(table):
    """The lines of a table without the columns of what iterations cost, which hang on round-off and so on the processor."""
    lines = [line.split("|") for line in table.splitlines()]
    left_out = {k for k, cell in enumerate(lines[0]) if cell.strip() in COST} if lines else set()
    return ["|".join(cell for k, cell in enumerate(line) if k not in left_out) for line in lines]


def differences(name, old, new):
    """Lines of a table that are not as they were."""
    before, after = compared(old), compared(new)
    if len(before) != len(after):
        yield f"{name}: {len(before)} lines, now {len(after)}"
    for a, b in zip(before, after):
        if not same(a, b):
            yield f"{name}:\n    committed {a}\n    now       {b}"


def write(new):
    """Put tables into their pages."""
    for page in {page for page, name, _ in marked() if name in new}:
        text = MARKED.sub(lambda found: found[1] + new.get(found[2], found[3]) + found[4], page.read_text())
        page.write_text(text)


def slow(names, source):
    """What commands print, each of them run once, or what was printed before."""
    outputs = {}
    for name in names:
        command, which = SLOW[name]
        if source:
            outputs[command] = pathlib.Path(source).read_text()
        elif command not in outputs:
            outputs[command] = subprocess.run(command, shell=True, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
        write({name: printed(outputs[command], which)})


def quick(program, names, check, left_out):
    committed = {name: text for _, name, text in marked() if name in TABLES}
    missing = sorted(set(TABLES) - set(committed))
    wrong = [f"{name}: no page has this table" for name in missing]
    for name in sorted(committed):
        if (names and name not in names) or name in left_out:
            continue
        new = text_of(TABLES[name](program))
        if check:
            wrong += differences(name, committed[name], new)
        else:
            write({name: new})
    if wrong:
        sys.exit("\n".join(wrong) + ("\n(python3 docs/tables.py writes them anew)" if check else ""))


def listed():
    for page, name, _ in marked():
        how = " ".join(SLOW[name][0].split()) if name in SLOW else "quick"
        print(f"{name:20} {str(page.relative_to(ROOT)):40} {how}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true")
    arguments.add_argument("--all", action="store_true", help="with --check: those that take longest as well")
    arguments.add_argument("--list", action="store_true")
    arguments.add_argument("--slow", nargs="+", metavar="NAME", choices=list(SLOW))
    arguments.add_argument("--from", dest="source")
    arguments.add_argument("program", nargs="?", default="target/release/fecontact")
    arguments.add_argument("names", nargs="*")
    told = arguments.parse_args()
    unknown = sorted({name for _, name, _ in marked()} - set(SLOW) - set(TABLES))
    if unknown:
        sys.exit(f"no function and no command makes: {', '.join(unknown)}")
    if told.list:
        listed()
    elif told.slow:
        slow(told.slow, told.source)
    else:
        if not pathlib.Path(told.program).is_file():
            sys.exit(f"{told.program}: there is no program; cargo build --release, and name it before the tables")
        if set(told.names) - set(TABLES):
            sys.exit(f"not in the quick tier: {', '.join(sorted(set(told.names) - set(TABLES)))}")
        left_out = (LOOSE if told.all or told.names else LOOSE | LONG) if told.check else set()
        quick(str(pathlib.Path(told.program).resolve()), told.names, told.check, left_out)


if __name__ == "__main__":
    main()
