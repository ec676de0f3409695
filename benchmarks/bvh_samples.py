"""Odd but valid and broken BVH files: one small file (3 frames, 3 joints) and what to change."""

from __future__ import annotations

__all__ = ["BROKEN", "VALID", "text"]

PLAIN = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 5 0
    }
  }
  JOINT LeftLeg
  {
    OFFSET 2 -8 0
    CHANNELS 3 Xrotation Yrotation Zrotation
    End Site
    {
      OFFSET 0 -6 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.04
1 2 3 10 20 30 1 2 3 4 5 6
2 3 4 11 21 31 2 3 4 5 6 7
3 4 5 12 22 32 3 4 5 6 7 8
"""

Changes = list[tuple[str, str]]

VALID: dict[str, Changes] = {
    "plain": [],
    "CRLF": [("\n", "\r\n")],
    "tabs": [("  ", "\t")],
    "blank lines": [("MOTION\n", "\nMOTION\n"), ("Frame Time", "\nFrame Time")],
    "trailing blanks": [(" 6\n", " 6   \n"), (" 8\n", " 8\n\n  \n")],
    "no last newline": [("7 8\n", "7 8")],
    "byte order mark": [("HIERARCHY", "\ufeffHIERARCHY")],
    "comment": [("HIERARCHY", "# by hand\nHIERARCHY")],
    "brace on the line": [("Hips\n{", "Hips {")],
    "end site in small letters": [("End Site", "End site")],
    "end site joined": [("End Site", "EndSite")],
    "end site named": [("End Site", "End Site Toe")],
    "keywords in small letters": [("JOINT", "joint"), ("OFFSET", "offset")],
    "no blank after colon": [("Frames: ", "Frames:"), ("Time: ", "Time:")],
    "tab after colon": [("Frames: ", "Frames:\t"), ("Time: ", "Time:\t")],
    "time without leading zero": [("0.04", ".04")],
    "exponents": [("0.04", "4e-2"), ("1 2 3 10", "1e0 2E+0 3e-000 10")],
    "one line": [(" 6\n2", " 6 2"), (" 7\n3", " 7 3")],
    "frames over lines": [("30 1", "30\n1"), ("31 2", "31\n2"), ("32 3", "32\n3")],
    "rotations first": [
        (
            "Xposition Yposition Zposition Zrotation Xrotation Yrotation",
            "Zrotation Xrotation Yrotation Xposition Yposition Zposition",
        )
    ],
    "position on every joint": [
        ("3 Zrotation X", "6 Xposition Yposition Zposition Zrotation X"),
        ("3 Xrotation Y", "6 Xposition Yposition Zposition Xrotation Y"),
        ("30 1 2 3 4", "30 0 10 0 1 2 3 2 -8 0 4"),
        ("31 2 3 4 5", "31 0 10 0 2 3 4 2 -8 0 5"),
        ("32 3 4 5 6", "32 0 10 0 3 4 5 2 -8 0 6"),
    ],
    "root without positions": [
        ("6 Xposition Yposition Zposition", "3"),
        ("\n1 2 3 10", "\n10"),
        ("\n2 3 4 11", "\n11"),
        ("\n3 4 5 12", "\n12"),
    ],
    "two rotations": [
        ("3 Zrotation Xrotation Yrotation", "2 Zrotation Xrotation"),
        ("30 1 2 3", "30 1 2"),
        ("31 2 3 4", "31 2 3"),
        ("32 3 4 5", "32 3 4"),
    ],
    "one rotation": [
        ("3 Zrotation Xrotation Yrotation", "1 Xrotation"),
        ("30 1 2 3", "30 1"),
        ("31 2 3 4", "31 2"),
        ("32 3 4 5", "32 3"),
    ],
    "no rotation": [
        ("3 Zrotation Xrotation Yrotation", "0"),
        ("30 1 2 3", "30"),
        ("31 2 3 4", "31"),
        ("32 3 4 5", "32"),
    ],
    "name with blanks": [("JOINT Spine", "JOINT Bip01 L Spine")],
    "duplicate joint": [("LeftLeg", "Spine")],
    "glued numbers": [("10 20 30", "10-20-30")],
    "decimal commas": [("10 20 30", "10,5 20,5 30"), ("0.04", "0,04")],
    "scale channels": [
        ("3 Zrotation X", "6 Xscale Yscale Zscale Zrotation X"),
        ("30 1 2", "30 1 1 1 1 2"),
        ("31 2 3", "31 1 1 1 2 3"),
        ("32 3 4", "32 1 1 1 3 4"),
    ],
    "a gap": [("31 2 3", "31 nan 3")],
}

BROKEN: dict[str, Changes] = {
    "empty": [(PLAIN, "")],
    "header only": [(PLAIN[PLAIN.index("MOTION") :], "")],
    "cut in the hierarchy": [(PLAIN[PLAIN.index("JOINT LeftLeg") :], "")],
    "cut in a frame": [(" 31 2 3 4 5 6 7\n3 4 5 12 22 32 3 4 5 6 7 8\n", "")],
    "a frame missing": [("3 4 5 12 22 32 3 4 5 6 7 8\n", "")],
    "a value missing": [("31 2 3", "31 2")],
    "a value too many": [("31 2 3", "31 2 3 3")],
    "infinity": [("31 2 3", "31 inf 3")],
    "a word": [("31 2 3", "31 two 3")],
    "underscore": [("31 2 3", "31 2_0 3")],
    "unknown channel": [("Zrotation Xr", "Wrotation Xr")],
    "too many channels counted": [("CHANNELS 3 X", "CHANNELS 4 X")],
    "too few channels counted": [("CHANNELS 3 X", "CHANNELS 2 X")],
    "brace missing": [("  }\n}\nMOTION", "  }\nMOTION")],
    "brace too many": [("}\nMOTION", "}\n}\nMOTION")],
    "no root": [("ROOT Hips\n", "")],
    "offset short": [("OFFSET 0 10 0", "OFFSET 0 10")],
    "offset of words": [("OFFSET 0 10 0", "OFFSET 0 x 0")],
    "frame time zero": [("0.04", "0")],
    "frame time negative": [("0.04", "-0.04")],
    "no frame time": [("Frame Time: 0.04\n", "")],
    "10^12 frames": [("Frames: 3", "Frames: 1000000000000")],
    "rubbish": [(PLAIN, "\x00\x01\x02\x7fELF" * 100)],
}


def text(changes: Changes) -> str:
    """Return the small file with parts replaced everywhere."""
    result = PLAIN
    for old, new in changes:
        if old not in result:
            raise ValueError(f"{old!r} is not in the sample")
        result = result.replace(old, new)
    return result
