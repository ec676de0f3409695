"""Which joint of a skeleton is which of the canonical body: proposed, edited by hand, kept."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from roundelay.base.checks import expected
from roundelay.base.errors import FormatError, SkeletonMismatch
from roundelay.base.files import written_beside
from roundelay.geometry.skeleton import Skeleton
from roundelay.retargeting.canonical import JOINTS, NEEDED, Kind, joints_of

__all__ = ["BodyMap", "read_maps", "unlike", "write_maps"]

_KINDS: tuple[Kind, ...] = ("biped", "quadruped")
# A map is a page of names.
_LARGEST = 1 << 20


@dataclass(frozen=True)
class BodyMap:
    """Tell which joint of a skeleton is which of the canonical body.

    Parameters
    ----------
    kind : {"biped", "quadruped"}
    joints : dict of str to str
        The skeleton's joint for each joint of the canonical body that it has; see
        `roundelay.retargeting.canonical.JOINTS`. Hips, arms and legs are needed; spine, neck, head,
        shoulders, hands, toes and tail may be missing.

    Raises
    ------
    ValueError
        If the kind or a joint is not known, one that is needed is missing, or two share one.

    Examples
    --------
    >>> body = rl.map_body(rl.read("walk.bvh"))
    >>> rl.BodyMap(body.kind, body.joints).joints["head"]
    'Head'
    """

    kind: Kind
    joints: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if expected(str, self.kind) not in _KINDS:
            raise ValueError(f"expected a biped or a quadruped, found {self.kind!r}")
        known = joints_of(self.kind)
        expected(Mapping, self.joints)  # type: ignore[type-abstract]
        unknown = [name for name in self.joints if name not in known]
        if unknown:
            told = f"expected joints of the canonical body of a {self.kind}, found {unknown[0]!r}"
            raise ValueError(f"{told}; they are {', '.join(known)}")
        missing = [name for name in ("hips", *NEEDED) if name not in self.joints]
        if missing:
            raise ValueError(f"expected a joint for each of {', '.join(missing)}, found none")
        taken: dict[str, str] = {}
        for name, joint in self.joints.items():
            if joint in taken:
                told = f"{taken[joint]} and {name}, found {joint!r} for both"
                raise ValueError(f"expected different joints for {told}")
            taken[joint] = name

    @property
    def missing(self) -> tuple[str, ...]:
        """The joints of the canonical body that the skeleton does not have."""
        return tuple(name for name in joints_of(self.kind) if name not in self.joints)

    def indices(self, skeleton: Skeleton) -> dict[str, int]:
        """Return the number of the skeleton's joint for each of the canonical body.

        Raises
        ------
        SkeletonMismatch
            If a joint does not exist, or limbs do not hang as they must.
        """
        return {name: skeleton.index(joint) for name, joint in self.joints.items()}

    def record(self) -> dict[str, Any]:
        """Describe it as plain data, which `of_record` reads."""
        ordered = {name: self.joints[name] for name in JOINTS if name in self.joints}
        return {"kind": self.kind, "joints": ordered}

    @classmethod
    def of_record(cls, told: Any) -> BodyMap:
        """Make it of plain data.

        Raises
        ------
        ValueError
            If the data is not that of a map.
        """
        joints = told.get("joints") if isinstance(told, dict) else None
        if not isinstance(joints, dict) or not all(isinstance(x, str) for x in joints.values()):
            raise ValueError("expected an object with 'kind' and 'joints', a name for each joint")
        return cls(told.get("kind", "biped"), joints)


def read_maps(path: str | PathLike[str]) -> dict[str, BodyMap]:
    """Read the maps of a file that `write_maps` wrote, or a person edited.

    Returns
    -------
    dict of str to BodyMap
        By "capture" and "character"; what the file does not hold is not there.

    Raises
    ------
    FormatError
        If the file holds no such maps.
    OSError
        If it cannot be read.
    """
    path = Path(path)
    if path.stat().st_size > _LARGEST:
        raise FormatError(f"expected a map of at most {_LARGEST} bytes", path=path)
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
        parts = {name: told[name] for name in ("capture", "character") if name in told}
        if not parts:
            raise ValueError("expected 'capture' or 'character', found neither")
        return {name: BodyMap.of_record(part) for name, part in parts.items()}
    except json.JSONDecodeError as error:
        raise FormatError(
            f"expected JSON, found {error.msg}", path=path, line=error.lineno, column=error.colno
        ) from None
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise FormatError(str(error) or "expected maps", path=path) from None


def write_maps(maps: Mapping[str, BodyMap], path: str | PathLike[str]) -> None:
    """Write maps by their names, to be kept or edited; the file appears whole or not at all."""
    with written_beside(Path(path)) as part:
        told = {name: one.record() for name, one in maps.items()}
        part.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def unlike(first: BodyMap, second: BodyMap) -> SkeletonMismatch | None:
    """Return what keeps a motion of one body from another; None where nothing does."""
    if first.kind == second.kind:
        return None
    told = f"expected two bodies of one kind, found a {first.kind} and a {second.kind}"
    return SkeletonMismatch(f"{told}: their limbs do not correspond")
