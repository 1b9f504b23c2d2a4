"""Checks every relative link of the documentation, and makes a book of it: python3 docs/book.py [--check] [OUT].

Pages lie where they are read in the repository: below docs/, beside cases and benches, in the root. The book (mdBook, `cargo install
mdbook`) is made of copies that lie alike, so that the same links hold in both. A page that is missing in docs/SUMMARY.md, a link or a
heading that does not exist, and any warning of mdBook end it with exit code 1. With --check there is no book.
"""

import html
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).parent.parent
LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^ *```.*?^ *```", re.M | re.S)
EQUATION = re.compile(r"^```math\n(.*?)^```", re.M | re.S)
# Pages of the book beside those below docs/.
BESIDE = ["README.md", "README.ja.md", "CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "CHANGELOG.md", "python/README.md", "benches/README.md"]


def pages():
    """All pages, relative to the root."""
    found = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("cases/*/README.md"), *(ROOT / page for page in BESIDE)]
    return sorted(path.relative_to(ROOT) for path in found)


def links(text):
    """Relative links outside of code."""
    plain = re.sub(r"`[^`\n]*`", "", FENCE.sub("", text))
    return [link for link in LINK.findall(plain) if not re.match(r"[a-z]+:", link)]


def headings(text):
    """Names that links may lead to."""
    titles = re.findall(r"^#+ (.*)$", FENCE.sub("", text), re.M)
    bare = [re.sub(r"[`*]|\]\([^)]*\)|\[", "", title) for title in titles]
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in bare}


def targets(page):
    """Every relative link of a page: as written, the file it leads to, and the heading in it."""
    for link in links((ROOT / page).read_text()):
        place, _, heading = urllib.parse.unquote(link).partition("#")
        yield link, (ROOT / page.parent / place).resolve() if place else (ROOT / page).resolve(), heading


def wrong():
    """What is wrong with the links of all pages."""
    listed = {path for _, path, _ in targets(pathlib.Path("docs/SUMMARY.md"))}
    for page in pages():
        if (ROOT / page).resolve() not in listed and page.name != "SUMMARY.md":
            yield f"{page} is not in docs/SUMMARY.md"
        for link, path, heading in targets(page):
            if not path.exists():
                yield f"{page}: {link} does not exist"
            elif heading and path.suffix == ".md" and heading not in headings(path.read_text()):
                yield f"{page}: {link}: there is no such heading"


def typeset(text):
    """Equations as the book's script finds them; where pages are read in the repository their fences do."""
    return EQUATION.sub(lambda found: f"<div>\n\\[ {html.escape(found[1].strip())} \\]\n</div>", text)


def copied(source):
    """Pages and what they show, lying as in the repository."""
    for page in pages():
        target = source / page
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(typeset((ROOT / page).read_text()))
        for _, path, _ in targets(page):
            if path.is_file() and path.suffix != ".md":
                beside = source / path.relative_to(ROOT.resolve())
                beside.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, beside)
    summary = (source / "docs/SUMMARY.md").read_text()
    (source / "docs/SUMMARY.md").unlink()
    moved = LINK.sub(lambda found: f"](docs/{found[1]})", summary).replace("](docs/../", "](")
    (source / "SUMMARY.md").write_text(moved)
    shutil.copyfile(ROOT / "docs/book.toml", source / "book.toml")


def book(out):
    """The book in a folder of its own."""
    source = out / "source"
    shutil.rmtree(out, ignore_errors=True)
    source.mkdir(parents=True)
    copied(source)
    made = subprocess.run(["mdbook", "build", source, "-d", (out / "book").resolve()], capture_output=True, text=True)
    said = made.stdout + made.stderr
    if made.returncode or re.search(r"\b(WARN|ERROR)\b", said):
        sys.exit(said)
    print(out / "book" / "index.html")


def main():
    found = list(wrong())
    if found:
        sys.exit("\n".join(found))
    arguments = [argument for argument in sys.argv[1:] if argument != "--check"]
    if "--check" not in sys.argv:
        book(pathlib.Path(arguments[0]) if arguments else ROOT / "target" / "documentation")


if __name__ == "__main__":
    main()
