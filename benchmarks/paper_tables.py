"""What the papers print in tables besides [C]'s: table 1 of [A], figures 5, 6 and 9 of [B]."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.raunio_tables import PUBLISHED

__all__ = ["BARBIC", "FIGURE_5", "FIGURE_6", "FIGURE_9", "TABLE_1", "TRIALS", "Trajectory"]


@dataclass(frozen=True)
class Trajectory:
    """A row of table 1: frames, PCA dimension, birth, largest scale, simplices, seconds, fps."""

    trial: str
    frames: tuple[int, int]
    dimensions: int | None
    born: float
    end: float
    simplices: int
    cohomology: float
    processing: float | None
    frames_a_second: float | None


# trial, start, stop, PCA, born, end, simplices, seconds of cohomology, of post-processing, fps.
# 143_23: the table prints frames 100 to 200, the text 400 frames. 142_06 and 142_08: the table
# prints the stop 009; a stop of 600 is meant.
_TABLE_1 = """
01_09 0 4238 - 8.98 50.00 1946901 64.21 - -
02_07 0 2247 - 23.04 50.00 8285462 108.86 - -
05_13 0 1091 - 40.92 50.00 446979 7.04 - -
13_29 0 1200 - 19.36 30.00 817463 11.04 - -
69_01 200 450 - 9.95 50.00 290566 7.07 18.71 9.70
69_42 100 250 - 16.77 28.00 30292 0.53 12.09 11.89
77_10 225 325 - 37.34 59.90 6485 0.11 12.07 8.21
104_19 225 550 - 8.18 50.00 326580 7.09 18.90 12.50
125_01 1300 1900 - 14.78 100.00 1606061 43.77 50.84 6.34
125_05 1500 2200 - 45.67 72.00 1180629 30.61 44.70 9.29
142_04 250 650 3 8.06 40.00 374216 2.96 24.14 14.76
142_05 300 1000 3 1.58 24.00 2693262 27.01 75.42 6.83
142_06 300 600 3 8.32 40.00 121898 1.21 18.49 15.23
142_07 450 1000 2 1.22 14.00 2153124 21.60 61.84 6.59
142_08 300 600 - 15.80 50.00 183922 3.76 15.87 15.28
142_11 300 800 - 9.60 39.00 193445 4.51 14.83 25.85
142_12 310 710 2 3.12 30.00 995299 8.43 36.68 8.87
142_15 300 1200 3 2.11 20.00 4212216 44.06 122.37 5.41
143_01 0 96 - 24.83 50.00 3334 0.07 11.41 8.36
143_05 100 240 - 58.38 105.00 32014 0.53 11.83 11.33
143_15 450 587 - 34.51 85.00 27740 0.49 11.94 11.02
143_16 52 186 - 52.07 110.00 35962 0.78 12.09 10.41
143_17 394 603 - 34.06 50.00 25471 0.43 12.29 24.37
143_18 28 763 - 16.28 50.00 1810614 51.99 61.73 6.46
143_23 100 500 4 5.66 30.00 844627 12.72 - -
143_28 40 441 - 7.02 50.00 188371 1.58 20.35 18.29
143_32 30 270 - 14.06 50.00 128308 2.41 14.10 14.54
143_40 1 425 - 16.31 40.00 548524 13.48 25.30 10.93
143_41 80 380 2 3.06 20.00 473866 3.81 25.59 10.20
"""


def _row(line: str) -> Trajectory:
    trial, start, stop, axes, born, end, simplices, before, after, fps = line.split()
    return Trajectory(
        trial,
        (int(start), int(stop)),
        None if axes == "-" else int(axes),
        float(born),
        float(end),
        int(simplices),
        float(before),
        None if after == "-" else float(after),
        None if fps == "-" else float(fps),
    )


TABLE_1 = tuple(_row(line) for line in _TABLE_1.split("\n") if line)

BARBIC = tuple(f"86_{number:02d}" for number in range(1, 15))
"""The fourteen sequences of [B]."""

# Rows and columns: walking, running, sitting down, forward jumping, climbing, arm stretching,
# punching, two of each.
FIGURE_5 = """
2 5 15 14 7 8 22 22 12 12 7 8 18 15
3 2 8 8 6 7 16 15 8 9 6 6 11 10
15 17 5 5 19 19 37 36 32 28 21 20 29 28
14 15 5 4 17 18 29 30 26 24 17 17 25 24
16 20 36 28 2 10 49 45 29 28 20 22 42 36
15 19 34 29 10 3 37 33 28 23 17 18 31 25
37 42 59 50 49 37 22 27 56 61 97 92 120 116
36 40 54 45 45 33 27 24 55 60 98 94 127 122
22 25 51 41 29 28 56 55 6 12 33 34 45 38
18 22 46 35 28 23 61 60 12 5 35 34 40 34
85 91 67 57 84 83 184 189 89 92 10 14 169 161
74 80 67 56 77 75 179 185 86 89 14 10 180 174
29 33 45 37 42 31 120 127 45 40 49 44 9 10
92 96 116 109 109 109 248 255 115 123 161 174 37 28
"""
FIGURE_6 = """
7 31 187 190 89 71 154 163 151 152 246 270 170 175
31 7 152 156 77 74 134 143 125 128 176 201 156 157
187 152 7 19 115 196 117 109 126 116 163 183 117 122
190 156 19 7 137 191 184 175 128 129 211 238 156 162
89 77 115 137 7 48 147 163 166 154 200 220 161 164
71 74 196 191 48 7 143 153 204 209 209 297 206 206
154 134 117 184 147 143 7 15 180 149 155 141 79 96
163 143 109 175 163 153 15 7 174 149 159 143 83 100
151 125 126 128 156 204 180 174 7 41 186 218 149 149
152 128 116 129 154 209 149 149 41 7 155 176 105 105
246 176 163 211 200 280 155 159 188 155 7 23 99 101
270 201 183 238 220 297 141 143 218 176 23 7 86 88
170 158 117 156 161 206 79 83 149 105 99 86 7 14
175 157 122 162 164 206 96 100 149 105 101 88 14 7
"""
# Precision and recall.
FIGURE_9 = {"pca-paper": (0.79, 0.88), "ppca-paper": (0.92, 0.95), "gmm-paper": (0.77, 0.71)}

TRIALS = {
    "A": tuple(row.trial for row in TABLE_1),
    "B": BARBIC,
    "C": tuple(row.trial for row in PUBLISHED),
}
"""The captures that each paper's tables name."""
