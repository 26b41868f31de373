"""Lists the data points and ends of error bars that a drawing does not show.

visible_points.py NAME.svg NAME.gp: the data, ranges and colours are those of the script; the drawing is rasterized
and read back. Ends with code 1 if anything is missing, with 77 if rsvg-convert or Pillow is not installed.
"""
import io
import math
import re
import shutil
import subprocess
import sys

try:
    from PIL import Image, ImageColor
except ImportError:
    sys.exit(77)
if shutil.which("rsvg-convert") is None:
    sys.exit(77)

ZOOM = 8
CAP = 1.2  # [px] beside the bar, within its cap
EDGE = 1  # [px] above and below the middle of a point, within its mark


def places_of(script, svg):
    """A function from data to pixels of the drawing without zoom; None outside the frame."""
    frame = re.findall(r"M([\d.]+),([\d.]+) L\1,([\d.]+) L([\d.]+),\3 L\4,\2 L\1,\2 Z", svg)[-1]
    left, top, bottom, right = map(float, frame)

    def scale(axis, begin, end):
        low, high = map(float, re.search(rf"set {axis}range \[(\S+):(\S+)\]", script).groups())

        def of(value):
            return value if f"set logscale {axis}" not in script else math.log(value) if value > 0 else -math.inf

        return lambda value: begin + (of(value) - of(low)) / (of(high) - of(low)) * (end - begin)

    x, y = scale("x", left, right), scale("y", bottom, top)

    def place(point):
        at = x(point[0]), y(point[1])
        return at if left <= at[0] <= right and top <= at[1] <= bottom else None

    return place


def points_of(script):
    """Name of each data block -> its rows [x, y, error of x or None, error of y or None]."""
    blocks = re.findall(r"^(\$series\d+) << EOD\n(.*?)^EOD$", script, re.M | re.S)
    return {name: [[float(cell) if cell else None for cell in line.split(",")] for line in lines.splitlines()]
            for name, lines in blocks}


def main():
    svg, script = (open(name, encoding="utf8").read() for name in sys.argv[1:3])
    png = subprocess.run(["rsvg-convert", f"--zoom={ZOOM}", sys.argv[1]], check=True, capture_output=True).stdout
    image = Image.open(io.BytesIO(png)).convert("RGB")
    place, points = places_of(script, svg), points_of(script)
    shown, missing = 0, []

    def look(what, at, enough, offsets, colour):
        nonlocal shown
        if place(at) is None:
            return
        (x, y), wanted = place(at), ImageColor.getrgb(colour)
        seen = [image.getpixel((int((x + dx) * ZOOM), int((y + dy) * ZOOM))) for dx, dy in offsets]
        if enough(max(abs(a - b) for a, b in zip(pixel, wanted)) < 40 for pixel in seen):
            shown += 1
        else:
            missing.append(f"{what} of {colour} at {at}: {seen}")

    for name, every, style, colour in re.findall(
            r"(\$series\d+) every (\d+) using \S+ with (\w+).*?lc rgb '(\S+)'", script):
        for x, y, _, y_error in points[name][::int(every)]:
            if "points" in style:
                look("point", (x, y), all, [(0, -EDGE), (0, 0), (0, EDGE)], colour)
                continue
            for end in (-1, 1):
                if y_error:
                    look("bar", (x, y + end * y_error), any, [(-CAP, 0), (CAP, 0)], colour)
    print(f"{shown} shown, {len(missing)} missing")
    print("\n".join(missing))
    sys.exit(1 if missing or not shown else 0)


main()
