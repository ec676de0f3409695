"""Tables that people edit: ours and other programs', and what is wrong with them."""

import itertools

import pytest

import roundelay as rl
from roundelay.base.errors import FormatError
from roundelay.segmentation import edited_segments, segment, tab_separated

FRAMES, FPS = 600, 60.0


def read(tmp_path, text):
    path = tmp_path / "edited.csv"
    path.write_text(text, encoding="utf-8")
    return edited_segments(path, FRAMES, FPS)


def parts(found):
    return [(each.start, each.stop, each.name) for each in found.segments]


@pytest.mark.parametrize(
    "text",
    [
        "start,end,label\n0,4,walk\n4,6.5,run\n6.5,10,walk\n",
        "start;end;name\n4;6.5;run\n0;4;walk\n6.5;10;walk\n",
        "\ufeffBegin Time\tEnd Time\tValue\n0\t4\twalk\n4\t6.5\trun\n6.5\t10\twalk\n",
        "Observation id,Behavior,Start (s),Stop (s)\nx,walk,0,4\nx,run,4,6.5\nx,walk,6.5,10\n",
        "0.000\t4.000\twalk\n4.000\t6.500\trun\n\n6.500\t10.000\twalk\n",
    ],
)
def test_tables_of_several_programs(tmp_path, text):
    found = read(tmp_path, text)
    assert parts(found) == [(0, 240, "walk"), (240, 390, "run"), (390, 600, "walk")]
    assert [each.label for each in found.segments] == [0, 1, 0]
    assert (found.n_frames, found.method, found.options.file) == (600, "edited", "edited.csv")


def test_what_is_left_out_has_no_name(tmp_path):
    found = read(tmp_path, "start,end,name\n2,3,walk\n5,6,walk\n")
    names = [(0, 120, ""), (120, 180, "walk"), (180, 300, ""), (300, 360, "walk"), (360, 600, "")]
    assert parts(found) == names
    assert [each.label for each in found.segments] == [0, 1, 0, 1, 0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected a row for each behaviour, found none"),
        ("start,end,name\n", "expected a row for each behaviour, found none"),
        ("a,b,c\n1,2,x\n", ":1: expected a heading with the columns"),
        ("start,end,name\n1,2,x\n1.5,3,y\n", ":3: expected behaviours that do not overlap"),
        ("start,end,name\n2,1,x\n", ":2: expected a behaviour within 0 and 10 s"),
        ("start,end,name\n2,11,x\n", ":2: expected a behaviour within 0 and 10 s"),
        ("start,end,name\n-1,2,x\n", ":2: expected a behaviour within 0 and 10 s"),
        ("start,end,name\n1,soon,x\n", ":2: expected a time in seconds, found 'soon'"),
        ("start,end,name\n1,nan,x\n", ":2: expected a time in seconds, found 'nan'"),
        (
            "start,end,name,start_frame,end_frame\n1,2,x,60,150\n",
            ":2: expected end_frame as the seconds beside it, 120, found 150",
        ),
        ("start,end,name\n1\n", ":2: expected a time in seconds, found ''"),
    ],
)
def test_faults_are_told_with_their_line(tmp_path, text, message):
    with pytest.raises(FormatError) as raised:
        read(tmp_path, text)
    assert message in str(raised.value)
    assert "edited.csv" in str(raised.value)


def test_a_table_that_is_no_text(tmp_path):
    path = tmp_path / "edited.csv"
    path.write_bytes(b"\xff\xfe\x00start")
    with pytest.raises(FormatError, match="expected a table as UTF-8 text"):
        edited_segments(path, FRAMES, FPS)


def test_what_is_written_is_read_again(capture, tmp_path):
    found = segment(capture.motion)
    motion = capture.motion
    for name, text in (("a.csv", found.to_csv()), ("a.txt", tab_separated(found))):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        again = edited_segments(path, len(motion), motion.fps)
        assert again.cuts == found.cuts
        assert [each.label for each in again.segments] == [each.label for each in found.segments]
        assert [each.title for each in again.segments] == [each.title for each in found.segments]


def test_cuts_that_are_known_get_their_periods(capture, tmp_path):
    motion = capture.motion
    path = tmp_path / "edited.csv"
    stops = [0, *segment(motion).cuts, len(motion)]
    rows = [
        f"{a / motion.fps},{b / motion.fps},{'xyz'[k % 3]}"
        for k, (a, b) in enumerate(itertools.pairwise(stops))
    ]
    path.write_text("\n".join(["start,end,name", *rows]), encoding="utf-8")
    known = edited_segments(path, len(motion), motion.fps)
    found = rl.segment(motion, method=known)
    assert parts(found) == parts(known)
    assert [each.kind for each in found.segments] == ["cyclic"] * 6
    with pytest.raises(ValueError, match="expected a motion of"):
        rl.segment(motion[:500], method=known)
