"""Builds the book as pages that open offline: python3 .ci/build_book.py [FOLDER], default target/book.

The pages of docs/book link to documents and data elsewhere in the repository, so that they can be read there as well. This script
copies the book and whatever it links to into one folder, follows the links of copied documents, and runs mdBook on it. It fails on a
warning of mdBook and on a link that leads nowhere.
"""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys

from check_links import LINK, ROOT

BOOK = ROOT / "docs" / "book"
STAGED = ROOT / "target" / "book-source"
# Documents from elsewhere that become chapters, with their titles.
CHAPTERS = {
    "README.md": "README",
    "benchmarks/scenes/README.md": "Scene files",
    "docs/data.md": "Records and CSV columns",
    "docs/limits.md": "Every limit",
    "docs/fmu.md": "FMUs",
    "docs/rexs.md": "REXS",
    "docs/reduction-format.md": "Format of reductions",
    "docs/seeds.md": "Figures of the publications",
    "docs/skewed-contact.md": "Skewed contact",
    "examples/README.md": "Gallery",
    "CHANGELOG.md": "Changes",
    "CONTRIBUTING.md": "Contributing",
    "SECURITY.md": "Security",
}


def staged_place(path):
    """Where a file of the repository is in the staged folder: pages of the book at its root, all else under `repository`."""
    try:
        return path.relative_to(BOOK / "src")
    except ValueError:
        path = path.relative_to(ROOT)
        return pathlib.Path("repository") / (path.with_name("start.md") if path.name == "README.md" else path)


def outside_code(text, change):
    """Applies a change to the text outside of fenced code."""
    parts = re.split(r"(^```.*?^```[^\n]*$)", text, flags=re.M | re.S)
    return "".join(part if i % 2 else change(part) for i, part in enumerate(parts))


def stage_examples(source):
    """Adds the examples in Python as pages, with what they have printed where `.ci/python.sh` has run them; their summary."""
    spec = importlib.util.spec_from_file_location("notebooks", ROOT / "python" / "notebooks.py")
    notebooks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(notebooks)
    lines = ["", "# Examples in Python", ""]
    (source / "examples-in-python").mkdir(parents=True, exist_ok=True)
    for path in sorted((ROOT / "python" / "examples").glob("*.py")):
        made = ROOT / "target" / "notebooks" / f"{path.stem}.md"
        cells = notebooks.cells(path.read_text(encoding="utf-8"))
        text = made.read_text(encoding="utf-8") if made.exists() else notebooks.page(cells, [""] * len(cells))
        (source / "examples-in-python" / made.name).write_text(text, encoding="utf-8")
        title = text.partition("\n")[0].removeprefix("# ")
        lines.append(f"- [{title}](examples-in-python/{made.name})")
    return "\n".join(lines) + "\n"


def stage():
    """Copies the book and all that it links to, with links from page to page."""
    shutil.rmtree(STAGED, ignore_errors=True)
    source = STAGED / "src"
    documents = [p for p in (BOOK / "src").rglob("*") if p.is_file()] + [ROOT / c for c in CHAPTERS if (ROOT / c).is_file()]
    done = set()
    while documents:
        path = documents.pop()
        if path in done:
            continue
        done.add(path)
        place = source / staged_place(path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix != ".md":
            shutil.copyfile(path, place)
            continue

        def changed(match, path=path, place=place):
            target, _, anchor = match.group(1).partition("#")
            if not target or ":" in target:
                return match.group(0)
            file = (path.parent / target).resolve()
            if file.is_dir():
                file = file / "README.md"
            if file.name == "SUMMARY.md":  # the table of contents is at the side of every page
                file = file.with_name("introduction.md")
            if not file.is_file():
                sys.exit(f"{path.relative_to(ROOT)}: {target} leads nowhere")
            chapter = file.suffix != ".md" or (BOOK / "src") in file.parents or str(file.relative_to(ROOT)) in CHAPTERS
            if not chapter:  # a document that is no chapter is copied as plain text
                there = source / "repository" / file.relative_to(ROOT).with_suffix(".txt")
                there.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, there)
            else:
                documents.append(file)
                there = source / staged_place(file)
            to = pathlib.PurePath(os.path.relpath(there, place.parent)).as_posix()
            before = match.group(0)[: match.start(1) - match.start()]
            return before + to + ("#" + anchor if anchor else "") + ")"

        text = path.read_text(encoding="utf-8")
        place.write_text(outside_code(text, lambda part: LINK.sub(changed, part)), encoding="utf-8")
    summary = source / "SUMMARY.md"
    examples = stage_examples(source)
    listed = [f"- [{title}]({staged_place(ROOT / path).as_posix()})" for path, title in CHAPTERS.items() if (ROOT / path).is_file()]
    summary.write_text(summary.read_text(encoding="utf-8") + examples + "\n# Documents of the repository\n\n" + "\n".join(listed) + "\n", encoding="utf-8")
    shutil.copyfile(BOOK / "book.toml", STAGED / "book.toml")


def check(pages):
    """Links of the built pages that lead to no file or to no anchor."""
    ids = {}
    for page in pages.rglob("*.html"):
        ids[page.resolve()] = set(re.findall(r'\bid="([^"]+)"', page.read_text(encoding="utf-8")))
    broken = []
    for page in ids:
        if page.name in ("print.html", "toc.html", "404.html"):  # print.html has every page's links, relative to other folders
            continue
        for target in re.findall(r'(?:href|src)="([^"]+)"', page.read_text(encoding="utf-8")):
            path, _, anchor = target.partition("#")
            if ":" in path or path.startswith("//"):
                continue
            file = (page.parent / path).resolve() if path else page
            if not file.exists() or anchor and file in ids and anchor not in ids[file]:
                broken.append(f"{page.relative_to(pages.resolve())}: {target}")
    return broken


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "book").resolve()
    own = ROOT / "target" / "tools" / "bin" / "mdbook"
    mdbook = str(own) if own.is_file() else shutil.which("mdbook")
    if mdbook is None:
        sys.exit("mdbook is not installed: cargo install mdbook --version 0.5.4 --locked")
    stage()
    built = subprocess.run([mdbook, "build", str(STAGED), "--dest-dir", str(out)], capture_output=True, text=True)
    print(built.stdout + built.stderr, end="")
    if built.returncode != 0 or "WARN" in built.stderr + built.stdout:
        sys.exit("mdBook warns")
    broken = check(out)
    if broken:
        sys.exit("links that lead nowhere:\n" + "\n".join(broken))
    print(f"book: {out / 'index.html'}")


if __name__ == "__main__":
    main()
