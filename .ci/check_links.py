"""Checks relative links and anchors of the repository's Markdown files: python3 .ci/check_links.py."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def lines_of(page):
    """Lines of a page without code blocks."""
    inside = False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            inside = not inside
        elif not inside:
            yield number, line


def anchors(page):
    """Anchors of a page, as GitHub makes them from headings."""
    found = {}
    names = set()
    for _, line in lines_of(page):
        heading = re.match(r"#+ (.*)", line)
        if heading:
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.group(1)).lower()
            name = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            count = found.get(name, 0)
            found[name] = count + 1
            names.add(name if count == 0 else f"{name}-{count}")
    return names


def main():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    broken = []
    links = 0
    for name in listed.stdout.split("\n"):
        page = ROOT / name
        if not name or not page.exists():
            continue
        for number, line in lines_of(page):
            for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if re.match(r"[a-z]+:", target):
                    continue
                links += 1
                path, _, anchor = target.partition("#")
                goal = (page.parent / path).resolve() if path else page
                if not goal.exists():
                    broken.append(f"{name}:{number}: there is no {target}")
                elif anchor and goal.suffix == ".md" and anchor not in anchors(goal):
                    broken.append(f"{name}:{number}: there is no heading #{anchor} in {path or name}")
    book = ROOT / "docs/book/src"
    contents = (book / "SUMMARY.md").read_text(encoding="utf-8")
    for page in book.rglob("*.md"):
        part = page.relative_to(book).as_posix()
        if part != "SUMMARY.md" and f"({part})" not in contents:
            broken.append(f"docs/book/src/{part}: not in SUMMARY.md")
    print("\n".join(broken) if broken else f"{links} links, none broken")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
