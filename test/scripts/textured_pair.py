#!/usr/bin/python3
"""Writes left.pgm and right.pgm, a rectified pair of a textured wall and a box in front of it.

Usage: textured_pair.py FOLDER
"""
import pathlib
import random
import sys

WIDTH, HEIGHT = 160, 120
WALL_DISPARITY = 12
BOX_DISPARITY = 20
BOX_ROWS, BOX_COLUMNS = range(40, 80), range(70, 110)  # in the left image


def write(folder):
    draw = random.Random(7)
    wall = [[draw.randrange(256) for _ in range(WIDTH + WALL_DISPARITY)] for _ in range(HEIGHT)]
    box = [[draw.randrange(256) for _ in range(WIDTH)] for _ in range(HEIGHT)]
    left = [row[:WIDTH] for row in wall]
    right = [row[WALL_DISPARITY:] for row in wall]
    for y in BOX_ROWS:
        for x in BOX_COLUMNS:
            left[y][x] = box[y][x]
            right[y][x - BOX_DISPARITY] = box[y][x]
    for name, rows in (("left.pgm", left), ("right.pgm", right)):
        pixels = b"".join(bytes(row) for row in rows)
        (pathlib.Path(folder) / name).write_bytes(b"P5 %d %d 255\n" % (WIDTH, HEIGHT) + pixels)


if __name__ == "__main__":
    write(sys.argv[1])
