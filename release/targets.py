"""The systems that roundelay is given out for, as zig, pip and the kernel's loader name them."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

__all__ = ["TARGETS", "Target"]


@dataclass(frozen=True)
class Target:
    """One system.

    Attributes
    ----------
    name : str
        What ``_kernel-NAME`` is called where several kernels lie side by side.
    zig : str
        The system with the oldest version of it that is served, as zig writes them.
    platform : str
        The platform tag of the wheel.
    suffix : str
        What the file of a shared library ends in.
    """

    name: str
    zig: str
    platform: str
    suffix: str

    @property
    def tag(self) -> str:
        """The wheel's tag: the kernel asks nothing of Python."""
        return f"py3-none-{self.platform}"

    def wheel(self, folder: Path) -> Path:
        """Return the one wheel for this system in a folder."""
        found = sorted(folder.glob(f"roundelay-*-{self.tag}.whl"))
        if len(found) != 1:
            raise SystemExit(
                f"expected one wheel for {self.platform} in {folder}, found {len(found)}: "
                f"make wheels"
            )
        return found[0]


TARGETS = (
    Target("linux-x86_64", "x86_64-linux-gnu.2.17", "manylinux_2_17_x86_64", ".so"),
    Target("linux-aarch64", "aarch64-linux-gnu.2.17", "manylinux_2_17_aarch64", ".so"),
    Target("win-amd64", "x86_64-windows-gnu", "win_amd64", ".dll"),
    Target("win-arm64", "aarch64-windows-gnu", "win_arm64", ".dll"),
    Target("macosx-x86_64", "x86_64-macos.10.13", "macosx_10_13_x86_64", ".dylib"),
    Target("macosx-arm64", "aarch64-macos.11.0", "macosx_11_0_arm64", ".dylib"),
)


def main() -> None:
    """Print the wheel for this system in a folder: ``python -m release.targets dist``."""
    from roundelay.topology.kernel.compiled import _system

    (target,) = (one for one in TARGETS if one.name == _system())
    print(target.wheel(Path(sys.argv[1])))


if __name__ == "__main__":
    main()
