"""frames.py SCENE WIDTH HEIGHT COUNT: the same as frames.cpp, in Python."""

import sys
import time

import obscura

path, width, height, count = sys.argv[1], *map(int, sys.argv[2:])
renderer = obscura.Scene(path).frames(size=(width, height))
renderer.at(0)  # the context, the fonts
total = 0
begun = time.process_time()
for _ in range(count):
    total += int(next(renderer).array[0, 0, 0])
print(f"{time.process_time() - begun:.6f}")
sys.exit(total == 0)
