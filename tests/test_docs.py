"""Links within the pages lead somewhere, and the catalogue's page has every name and form."""

import re
from pathlib import Path

import pytest

from pipeline.physics.catalogue import (
    MEANINGS,
    QUEUE,
    RECURRING,
    RUBBING,
    SKIPS,
    WORN,
    force_terms,
    terms,
    with_richer,
)
from pipeline.physics.term import Term

ROOT = Path(__file__).resolve().parents[1]
PAGES = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("data/*.md")]
CATALOGUE = (ROOT / "docs" / "catalogue.md").read_text(encoding="utf-8")
OTHERS = (WORN, QUEUE, *RECURRING, *SKIPS, *RUBBING)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def headings(page: Path) -> set[str]:
    """Anchors of a page's headings: lower case, blanks as hyphens, no other signs."""
    titles = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_within_the_project_leads_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for link in LINK.findall(text):
        if link.startswith("http"):
            continue
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        assert target.exists(), link
        assert not anchor or anchor in headings(target), link


def test_pages_are_found() -> None:
    assert {"README.md", "CONTRIBUTING.md", "studies.md"} <= {page.name for page in PAGES}


@pytest.mark.parametrize("one", [*terms(["CHANNEL"]), *force_terms()], ids=lambda t: t.name)
def test_the_catalogues_page_has_every_name_with_its_site_and_meaning(one: Term) -> None:
    assert f"| `{one.name}` | " in CATALOGUE
    named = [line for line in CATALOGUE.splitlines() if line.startswith(f"| `{one.name}` | ")]
    assert all(f" | {MEANINGS[one.name]} |" in line for line in named)
    assert one.form == "force" or any(f" | {one.site} | " in line for line in named)


@pytest.mark.parametrize(
    "one",
    [
        t
        for t in with_richer((*terms(["CHANNEL"]), WORN, QUEUE, *RECURRING, *SKIPS, *RUBBING))
        if t.form
    ],
    ids=lambda t: f"{t.name}/{t.form}",
)
def test_the_catalogues_page_has_every_form_of_what_moves(one: Term) -> None:
    row = next(line for line in CATALOGUE.splitlines() if line.startswith(f"| `{one.name}` | "))
    assert f"`{one.form}`" in row
