"""Writes a world in the manner of the BARN challenge to standard output, as SDF: a field of cylinders between three walls.

    python3 generate.py SEED > field.world

The robot starts at (-2.25, 3) and has to reach (-2.25, 13). A path of at least 0.9 m in width leads through the field; a
comment in the world gives its length. The shortest path may be shorter.
"""

import math
import random
import sys

RADIUS = 0.075
START, GOAL = (-2.25, 3.0), (-2.25, 13.0)
WIDTH, DENSITY = 0.9, 3.0

MODEL = """    <model name='{name}'>
      <static>1</static>
      <pose>{x:.6f} {y:.6f} 0 0 0 0</pose>
      <link name='link'>
        <collision name='collision'>
          <geometry>{geometry}</geometry>
        </collision>
      </link>
    </model>"""


def distance(point, start, end):
    """Distance of a point from a straight piece of way."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    share = ((point[0] - start[0]) * dx + (point[1] - start[1]) * dy) / (dx * dx + dy * dy)
    share = min(1, max(0, share))
    return math.hypot(point[0] - start[0] - share * dx, point[1] - start[1] - share * dy)


def main():
    draw = random.Random(int(sys.argv[1]))
    bends = [(draw.uniform(-3.6, -0.9), y) for y in (6.0, 8.0, 10.0)]
    way = [START, *bends, GOAL]
    pieces = list(zip(way, way[1:]))
    cylinder = f"<cylinder><radius>{RADIUS}</radius><length>1</length></cylinder>"
    box = "<box><size>{} {} 1</size></box>"
    models = [(-4.5, 7.5, box.format(0.1, 15)), (0, 7.5, box.format(0.1, 15)), (-2.25, 0, box.format(4.6, 0.1))]
    for _ in range(int(DENSITY * 4.3 * 5)):
        place = (draw.uniform(-4.35, -0.15), draw.uniform(5, 11))
        if all(distance(place, *piece) > WIDTH / 2 + RADIUS for piece in pieces):
            models.append((*place, cylinder))
    length = sum(math.dist(*piece) for piece in pieces)
    print("<sdf version='1.6'>")
    print(f"  <!-- length of the way: {length:.3f} m -->")
    print("  <world name='default'>")
    for number, (x, y, geometry) in enumerate(models):
        print(MODEL.format(name=f"obstacle_{number}", x=x, y=y, geometry=geometry))
    print("  </world>\n</sdf>")


main()
