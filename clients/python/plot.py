#!/usr/bin/env python3
"""Shakes a head of hair and draws active nodes, step time and kinetic energy over simulated time into a PNG file."""

import argparse
import math
import sys

import awtd
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def play(arguments):
    """(seconds, active nodes, step in ms, joules) of each frame: two seconds of sway, then rest."""
    rows = []
    with awtd.connect(arguments.address, arguments.token_file) as client:
        forest = client.create(arguments.style, arguments.strands)
        for i in range(1, int(60 * arguments.seconds) + 1):
            time_us = i * 1000000 // 60
            t = min(time_us * 1e-6, 2.0)
            frame = forest.drive(time_us, awtd.Pose((0.1 * math.sin(2 * math.pi * t), 0, 0)))
            rows.append((time_us * 1e-6, frame.active_nodes, frame.step_us * 1e-3, frame.kinetic_energy_j))
    return list(zip(*rows))


def draw(columns, path):
    figure, axes = plt.subplots(3, sharex=True, figsize=(8, 7))
    for axis, values, label in zip(axes, columns[1:], ("active nodes", "step, ms a frame", "kinetic energy, J")):
        axis.plot(columns[0], values)
        axis.set_ylabel(label)
    axes[-1].set_xlabel("simulated time, s")
    figure.tight_layout()
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--address", default="127.0.0.1:4680", help="HOST:PORT (default: %(default)s)")
    parser.add_argument("--token-file", help="default: where a daemon on this machine keeps it")
    parser.add_argument("--style", default="long", help="default: %(default)s")
    parser.add_argument("--strands", type=int, default=2000, help="default: %(default)s")
    parser.add_argument("--seconds", type=float, default=4, help="simulated (default: %(default)s)")
    parser.add_argument("png", help="the file to write")
    arguments = parser.parse_args()
    if arguments.seconds < 0.1:
        parser.error("--seconds is to be at least 0.1")
    try:
        draw(play(arguments), arguments.png)
    except (awtd.AwtError, OSError) as error:
        sys.exit(f"plot.py: {error}")


if __name__ == "__main__":
    main()
