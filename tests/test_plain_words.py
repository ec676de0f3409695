"""What everybody reads first is plain, and leads somewhere.

No sentence of the README or of the help has over 30 words; links between pages lead to pages.
"""

import re
from pathlib import Path

import pytest
from typer.main import get_command

from roundelay.cli import app

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
MOST = 30
COMMANDS = get_command(app).commands


def _sentences(text):
    return re.split(r"(?<=[.!?;:])\s+", text)


def _paragraphs(text):
    text = re.sub(r"```.*?```|<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    for part in re.split(r"\n\s*\n|\n\s*(?:[-*]|\d+\.)\s|\|", text):
        yield " ".join(part.split())


def _long(texts):
    found = (one for text in texts for one in _sentences(text))
    return [one for one in found if len(one.split()) > MOST]


def test_sentences_of_the_readme_are_short():
    assert _long(_paragraphs(README.read_text())) == []


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_sentences_of_the_help_are_short(name):
    command = COMMANDS[name]
    helps = [command.help, *(getattr(one, "help", None) for one in command.params)]
    assert _long(" ".join(text.split()) for text in helps if text) == []


def test_a_long_sentence_is_noticed():
    assert _long(["word " * (MOST + 1)])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_pages(page):
    for link in re.findall(r"\]\(([^)#\s]+)", page.read_text()):
        made = "_made/" in link or "_made" in page.parts
        assert made or re.match(r"[a-z]+:", link) or (page.parent / link).exists(), link
