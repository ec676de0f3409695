"""Fetching captures from a server, here one of this machine's own."""

from __future__ import annotations

import hashlib
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar

import pytest
from benchmarks import fetch_cmu
from benchmarks.paper_tables import TABLE_1, TRIALS


class Subjects(BaseHTTPRequestHandler):
    """Files by name; `cut` answers break off, `ranges` may be refused."""

    files: ClassVar[dict[str, bytes]] = {}
    cut: ClassVar[dict[str, int]] = {}
    ranges = True
    asked: ClassVar[list[tuple[str, str | None]]] = []

    def do_GET(self):
        name, asked = self.path.removeprefix("/subjects/"), self.headers.get("Range")
        self.asked.append((name, asked))
        if name not in self.files:
            self.send_error(404)
            return
        content, start = self.files[name], 0
        if asked and self.ranges:
            start = int(asked.removeprefix("bytes=").rstrip("-"))
            if start >= len(content):
                self.send_error(416)
                return
        self.send_response(206 if start else 200)
        self.send_header("Content-Length", str(len(content) - start))
        self.end_headers()
        stop = self.cut.pop(name, len(content))
        self.wfile.write(content[start:stop])

    def log_message(self, *words):
        pass


@pytest.fixture
def served(monkeypatch, tmp_path):
    """The captures of a made table, and what runs the fetcher on them."""
    names = {"asf": b"# made\n:version 1.10\n", "amc": b"#!made\n:FULLY-SPECIFIED\n:DEGREES\n"}
    files = {
        f"{trial[:2]}/{stem}.{kind}": names[kind] + stem.encode() * 40000
        for trial in ("02_01", "02_03", "07_01")
        for stem, kind in ((trial[:2], "asf"), (trial, "amc"))
    }
    monkeypatch.setitem(TRIALS, "C", ("02_01", "02_03", "07_01", "02_01"))
    for key, value in {"files": files, "cut": {}, "ranges": True, "asked": []}.items():
        monkeypatch.setattr(Subjects, key, value)
    server = ThreadingHTTPServer(("127.0.0.1", 0), Subjects)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    address = f"http://127.0.0.1:{server.server_address[1]}/subjects"
    out = tmp_path / "cmu"
    yield lambda: fetch_cmu.main(["--table", "C", "--out", str(out), "--from", address]), out
    server.shutdown()
    server.server_close()
    thread.join()


def whole(out):
    return all((out / "acclaim" / name).read_bytes() == x for name, x in Subjects.files.items())


def test_all_files_of_a_table_come_with_their_sums(served, capsys):
    run, out = served
    assert run() == 0
    assert whole(out)
    rows = dict(line.split("  ")[::-1] for line in (out / "SHA256SUMS").read_text().splitlines())
    assert rows == {
        f"acclaim/{name}": hashlib.sha256(x).hexdigest() for name, x in Subjects.files.items()
    }
    assert not list(out.rglob("*.part"))
    assert capsys.readouterr().out.count("fetched") == 5


def test_what_is_there_is_not_asked_for(served, capsys):
    run, out = served
    assert run() == 0
    (out / "SHA256SUMS").unlink()
    Subjects.asked.clear()
    assert run() == 0
    assert Subjects.asked == []
    assert len((out / "SHA256SUMS").read_text().splitlines()) == 5


@pytest.mark.parametrize("ranges", [True, False])
def test_a_download_that_was_cut_off_goes_on(served, capsys, monkeypatch, ranges):
    run, out = served
    monkeypatch.setattr(Subjects, "ranges", ranges)
    Subjects.cut["02/02_03.amc"] = 70000
    assert run() == 1
    told = capsys.readouterr()
    assert "02/02_03.amc: failed: " in told.out
    assert "1 files are missing; run it again" in told.err
    assert not (out / "acclaim/02/02_03.amc").exists()
    assert (out / "acclaim/02/02_03.amc.part").stat().st_size == 70000
    assert run() == 0
    assert whole(out)
    assert ("02/02_03.amc", "bytes=70000-") in Subjects.asked
    assert ("gone on with" in capsys.readouterr().out) == ranges


def test_a_whole_part_only_gets_its_name(served):
    run, out = served
    place = out / "acclaim/07/07_01.amc.part"
    place.parent.mkdir(parents=True)
    place.write_bytes(Subjects.files["07/07_01.amc"])
    assert run() == 0
    assert whole(out)


def test_a_changed_file_is_told_and_left(served, capsys):
    run, out = served
    assert run() == 0
    changed = out / "acclaim/02/02.asf"
    changed.write_bytes(b":version 1.11")
    assert run() == 1
    assert "02/02.asf: failed: expected SHA-256" in capsys.readouterr().out
    assert changed.read_bytes() == b":version 1.11"


def test_what_is_no_capture_is_not_kept(served, capsys):
    run, out = served
    Subjects.files["07/07.asf"] = b"<html>not here</html>"
    del Subjects.files["02/02_01.amc"]
    assert run() == 1
    told = capsys.readouterr().out
    assert "07/07.asf: failed: expected ':version' near its beginning, found b'<html>" in told
    assert "02/02_01.amc: failed: " in told
    assert "404" in told
    assert not list(out.rglob("*.part"))


def test_tables_name_the_captures_of_the_papers():
    assert len(TRIALS["A"]) == len(set(TRIALS["A"])) == 29
    assert len(TRIALS["B"]) == 14
    assert len(TRIALS["C"]) == 66
    # [A] 6: 24 captures with post-processing, 5 without.
    assert sum(row.processing is None for row in TABLE_1) == 5
    assert sum(row.dimensions is not None for row in TABLE_1) == 8
    assert "143_28" in {row.trial for row in TABLE_1}
