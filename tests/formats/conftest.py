from collections.abc import Callable
from pathlib import Path

import pytest

BVH = """HIERARCHY
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

ASF = """# a comment
:version 1.10
:name Test
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
   made by hand
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name lhip
     direction 1 0 0
     length 2
     axis 0 0 0 XYZ
  end
  begin
     id 2
     name lfemur
     direction 0 -1 0
     length 7.5
     axis 10 0 20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
     id 3
     name ltibia
     direction 0 -1 0
     length 7
     axis 0 0 20 XYZ
    dof rx
    limits (-10.0 170.0)
  end
:hierarchy
  begin
    root lhip
    lhip lfemur
    lfemur ltibia
  end
"""

AMC = """#!OML:ASF somewhere
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
lfemur 5 6 7
ltibia 8
2
root 2 3 4 11 21 31
lfemur 6 7 8
ltibia 9
"""


@pytest.fixture
def bvh(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes a BVH file, the sample with parts replaced by default."""

    def make(*changes: tuple[str, str], text: str | bytes | None = None, name="a.bvh") -> Path:
        content = BVH if text is None else text
        for old, new in changes:
            assert old in content
            content = content.replace(old, new, 1)
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return make


@pytest.fixture
def acclaim(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes an ASF and an AMC, samples with parts replaced."""

    def make(asf: tuple = (), amc: tuple = (), name: str = "07_01") -> Path:
        for suffix, content, changes in ((".asf", ASF, asf), (".amc", AMC, amc)):
            for old, new in changes:
                assert old in content
                content = content.replace(old, new, 1)
            stem = name.split("_")[0] if suffix == ".asf" else name
            (tmp_path / (stem + suffix)).write_bytes(content.encode())
        return tmp_path / (name + ".amc")

    return make
