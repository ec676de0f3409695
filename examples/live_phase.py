"""The phase of a walk while it comes in, by OSC as VMC programs send it.

A sender plays a walk to a socket on this computer, bone by bone (``/VMC/Ext/Bone/Pos``, then
``/VMC/Ext/T`` at the end of a frame). The receiver gives each frame to a `PhaseTracker`, tells what
the feet do next, and draws phase and confidence: a picture, or with ``--show`` a plot that runs.
VMC programs name bones as Unity does; a name that a skeleton lacks is left out.
"""

import socket
import struct
import sys
import threading
import time
from pathlib import Path

import numpy as np

import roundelay as rl
from roundelay import synth

FPS, FRAMES = 60.0, 300
show = "--show" in sys.argv
folder = Path(next((word for word in sys.argv[1:] if word != "--show"), "."))


def padded(text: bytes) -> bytes:
    """End a text by zeros, to a whole number of four bytes."""
    return text + b"\0" * (4 - len(text) % 4)


def message(address: str, *values: str | float) -> bytes:
    """An OSC message of texts and floats."""
    kinds = "," + "".join("s" if isinstance(value, str) else "f" for value in values)
    parts = [padded(v.encode()) if isinstance(v, str) else struct.pack(">f", v) for v in values]
    return padded(address.encode()) + padded(kinds.encode()) + b"".join(parts)


def read_message(packet: bytes) -> tuple[str, list[str | float]]:
    """The address and values of an OSC message."""

    def text(start: int) -> tuple[str, int]:
        stop = packet.index(b"\0", start)
        return packet[start:stop].decode(), stop + 4 - stop % 4

    address, place = text(0)
    kinds, place = text(place)
    values: list[str | float] = []
    for kind in kinds[1:]:
        if kind == "s":
            value, place = text(place)
            values.append(value)
        else:
            values.append(struct.unpack_from(">f", packet, place)[0])
            place += 4
    return address, values


def send(motion: rl.Motion, port: int) -> None:
    """Play a motion to a port of this computer, at its own rate where it is looked at."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        for number, rotations in enumerate(motion.rotations):
            for name, (w, x, y, z) in zip(motion.skeleton.names, rotations, strict=True):
                pose = message("/VMC/Ext/Bone/Pos", name, 0.0, 0.0, 0.0, *map(float, (x, y, z, w)))
                out.sendto(pose, ("127.0.0.1", port))
            out.sendto(message("/VMC/Ext/T", number / motion.fps), ("127.0.0.1", port))
            time.sleep(motion.frame_time if show else 0.001)


known = synth.gait("walk", repetitions=5, fps=FPS, rng=1)
cycle = rl.find_cycles(known.motion)[0]
live = synth.gait("walk", period=1.3, repetitions=FRAMES / 78, fps=FPS, noise=0.02, rng=1).motion
tracker, told = rl.PhaseTracker(cycle), []
frame = np.tile([1.0, 0.0, 0.0, 0.0], (cycle.skeleton.n_joints, 1))
place = {name: joint for joint, name in enumerate(cycle.skeleton.names)}

from roundelay.output import figures  # noqa: E402  Matplotlib loads here

figure = figures.new_figure(8.0, 4.0)
if show:
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(8.0, 4.0))
above, below = figure.subplots(2, 1, sharex=True)
(phases,), (sure,) = above.plot([], [], "."), below.plot([], [])
above.set(ylabel="phase", ylim=(0, 1), xlim=(0, len(live) / FPS))
below.set(ylabel="confidence", ylim=(0, 1.05), xlabel="seconds")


def draw() -> None:
    """Show what was told so far."""
    seconds = np.arange(len(told)) / FPS
    phases.set_data(seconds, [one.phase for one in told])
    sure.set_data(seconds, [one.confidence for one in told])


with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as inlet:
    inlet.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
    inlet.bind(("127.0.0.1", 0))
    inlet.settimeout(2.0)
    sender = threading.Thread(target=send, args=(live, inlet.getsockname()[1]), daemon=True)
    sender.start()
    while len(told) < len(live):
        try:
            address, values = read_message(inlet.recv(2048))
        except TimeoutError:
            break
        if address == "/VMC/Ext/Bone/Pos" and values[0] in place:
            x, y, z, w = values[4:8]
            frame[place[str(values[0])]] = w, x, y, z
        elif address == "/VMC/Ext/T":
            before = told[-1].event if told else ""
            told.append(tracker.frame(frame))
            if told[-1].event != before:
                print(f"{len(told) / FPS:5.2f} s: {told[-1].event} in {told[-1].seconds:.2f} s")
            if show and len(told) % 6 == 0:
                draw()
                plt.pause(0.001)

draw()
figures.save(figure, folder / "live_phase.png")
last = told[-1]
print(f"{len(told)} frames: {last.speed:.2f} periods a second, {last.confidence:.0%} sure")
