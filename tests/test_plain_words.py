"""What everybody reads first is plain: no sentence of the README or of the help over 30 words."""

import re
from pathlib import Path

import pytest
from typer.main import get_command

from roundelay.cli import app

README = Path(__file__).parent.parent / "README.md"
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
