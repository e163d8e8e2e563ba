"""Makes docs/gallery.md and its pictures: figures of the paper on our models, each with the commands that make it.

Usage: python3 docs/gallery/make.py DATA

DATA is the folder of test data (mesh/, points/, analytic/). Needs cargo, and the package pymeshlab for the mesh that
Figure 8 is held against. Takes about a minute.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent

INTRO = """# Gallery

Figures of *Interpolatory Refinement for Real-Time Processing of Point-Based Geometry* (Guennebaud, Barthe and Paulin 2005) on models
that can be had, with the commands that draw them and what `surfine evaluate` says. Where a result is not good yet, it is shown as it is.
[evaluation.md](evaluation.md) defines the measures. `python3 docs/gallery/make.py DATA` made this page; `data` stands for the folder of
test models. Models: Igea (Cyberware), Nefertiti (Egyptian Museum Berlin), fandisk (Pratt & Whitney, Hugues Hoppe),
armadillo (Stanford Computer Graphics Laboratory), the face of the libigl tutorial, Spot (Keenan Crane).
"""

# Each figure: title, text, commands. The last picture that a command writes is shown.
FIGURES = [
    (
        "Figure 1: irregular input",
        """The paper takes 3 500 random points of 150 000 on a statue and shows that no holes and no artefacts appear. Here: 3 500 random
points of Nefertiti, the refined cloud, and the true surface; below the ear from near, where points are few.""",
        [
            "surfine refine data/points/nefertiti-3500-random.ply -o nefertiti.ply --levels 4 -q",
            "surfine render data/points/nefertiti-3500-random.ply nefertiti.ply data/mesh/nefertiti.ply -o figure-1.png"
            " --size 420x560 --eye 2,-1.6,0.5 --up 0,0,1 --fit"
            " --caption '3 500 random points' --caption 'after 4 steps' --caption 'true surface'",
            "surfine render data/points/nefertiti-3500-random.ply nefertiti.ply data/mesh/nefertiti.ply -o figure-1-ear.png"
            " --size 420x420 --eye 0.62,-0.35,0.12 --target 0.1,-0.07,-0.03 --up 0,0,1"
            " --caption '3 500 random points' --caption 'after 4 steps' --caption 'true surface'",
            "surfine evaluate nefertiti.ply --truth data/mesh/nefertiti.ply --input data/points/nefertiti-3500-random.ply",
        ],
    ),
    (
        "Figure 8: smoothness",
        """The paper refines 600 points of Igea to 150 000 and finds the result smoother than butterfly subdivision of a mesh of the same
points. So it is: on the left a mesh by ball pivoting after four butterfly steps, in the middle our five steps, on the right the true
surface. Both interpolate the 600 points.""",
        [
            "python3 butterfly.py data/points/igea-600-uniform.ply butterfly.ply",
            "surfine refine data/points/igea-600-uniform.ply -o igea.ply --levels 5 -q",
            "surfine render butterfly.ply igea.ply data/mesh/igea.ply -o figure-8.png --size 480x600"
            " --caption 'butterfly subdivision' --caption 'Surfine' --caption 'true surface'",
            "surfine evaluate butterfly.ply --truth data/mesh/igea.ply",
            "surfine evaluate igea.ply --truth data/mesh/igea.ply --input data/points/igea-600-uniform.ply",
            "surfine evaluate igea.ply --truth data/mesh/igea.ply -q --heatmap figure-8-error.png --size 480x600 > /dev/null",
        ],
    ),
    (
        "Figure 9: a large hole",
        """The paper fills a hole by raising the radii of the points around it and refining eight times. Here a ball was cut out of Igea and
the radii of the 66 points around it reach across: Surfine takes that as the wish to fill the hole, does so at the density of the input, and
then refines. From the left: the hole, the fill, three steps, and the true surface, whose braid no rim can know.""",
        [
            "surfine fill data/points/igea-5000-hole.ply -o fill.ply",
            "surfine refine data/points/igea-5000-hole.ply -o hole.ply --levels 3 -q",
            "surfine render data/points/igea-5000-hole-open.ply fill.ply hole.ply data/mesh/igea.ply -o figure-9.png --size 400x480"
            " --eye=-1.3,0.4,1.2 --target=-0.05,0,0 --caption 'the hole' --caption 'filled' --caption 'and refined'"
            " --caption 'true surface'",
            "surfine evaluate hole.ply --truth data/mesh/igea.ply --input data/points/igea-5000-hole.ply",
        ],
    ),
    (
        "Figure 10: creases",
        """The paper keeps creases whose points have two normals. So do we: edges and corners stay sharp, each side is refined by itself,
and new points on the edges come with both normals.""",
        [
            "surfine refine data/points/fandisk-3000-crease.ply -o fandisk.ply --levels 4 -q",
            "surfine render data/points/fandisk-3000-crease.ply fandisk.ply -o figure-10.png --size 600x600 --view iso"
            " --caption '3 000 points, 497 on creases' --caption 'after 4 steps'",
            "surfine evaluate fandisk.ply --truth data/mesh/fandisk.ply --input data/points/fandisk-3000-crease.ply",
        ],
    ),
    (
        "Section 6: boundaries",
        """The paper treats the ends of an open surface as curves of their own. On the left three steps that take the surface for closed: the
rim of the neck is eaten away; on the right with the boundary.""",
        [
            "surfine refine data/points/face-4000-boundary.ply -o closed.ply --levels 3 -q --closed",
            "surfine refine data/points/face-4000-boundary.ply -o open.ply --levels 3 -q",
            "surfine render closed.ply open.ply -o section-6.png --size 600x260 --eye 0.28,-0.5,0.6"
            " --target 0.1,-0.38,0.15 --caption 'taken for closed' --caption 'with its boundary'",
            "surfine evaluate closed.ply --truth data/mesh/face.ply",
            "surfine evaluate open.ply --truth data/mesh/face.ply",
        ],
    ),
    (
        "Figure 11: sharp bends",
        """The paper shows holes at a sharp bend without the geodesic projection and without the curved angle. Here an ear of the armadillo, two
sheets less than an input spacing apart, after two steps by the paper's loop, which
asks for angles: with both, without the projection, without both, and the true surface. We see no
holes, but more wrong normals without the projection (orange: backs). [algorithm.md](algorithm.md#geodesic-projection-and-curved-angle) has figures.""",
        [
            "surfine refine data/points/armadillo-10000-uniform.ply -o both.ply --levels 2 -q --without largest_first",
            "surfine refine data/points/armadillo-10000-uniform.ply -o fuzzy.ply --levels 2 -q --without largest_first --neighborhood fuzzy",
            "surfine refine data/points/armadillo-10000-uniform.ply -o neither.ply --levels 2 -q --without largest_first --neighborhood fuzzy --plain-angle",
            "surfine render both.ply fuzzy.ply neither.ply data/mesh/armadillo.ply -o figure-11.png --size 380x340"
            " --eye=-0.25,0.42,0.45 --target=-0.075,0.312,0.122 --caption 'both' --caption 'no projection'"
            " --caption 'neither' --caption 'true surface'",
        ],
    ),
    (
        "Figure 12: colours",
        """The paper interpolates colours linearly from the three corners of each triangle. The last line compares with the colour of the
nearest input point.""",
        [
            "surfine refine data/points/spot-2500-colour.ply -o spot.ply --levels 4 -q",
            "surfine render data/points/spot-2500-colour.ply spot.ply -o figure-12.png --size 560x560 --view iso --color rgb"
            " --caption '2 500 points' --caption 'after 4 steps'",
            "surfine evaluate spot.ply --truth data/points/spot-15000-colour.ply --input data/points/spot-2500-colour.ply",
        ],
    ),
]


def run(command: str, folder: Path, environment: dict[str, str]) -> str:
    """What a command prints; the folder holds what it writes."""
    print(command, flush=True)
    done = subprocess.run(command, shell=True, cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    return "\n".join(line.rstrip() for line in done.stdout.splitlines())


def section(title: str, text: str, commands: list[str], folder: Path, environment: dict[str, str]) -> str:
    """One figure in Markdown; its pictures go beside this script."""
    before = set(folder.glob("*.png"))
    results = [run(command, folder, environment) for command in commands]
    pictures = sorted(set(folder.glob("*.png")) - before, key=lambda path: path.stat().st_mtime_ns)
    for picture in pictures:
        (HERE / picture.name).write_bytes(picture.read_bytes())
    shown = "\n\n".join(f"![{title}](gallery/{picture.name})" for picture in pictures)
    measured = [r for command, r in zip(commands, results) if r and command.startswith("surfine evaluate")]
    code = "\n".join(commands)
    parts = [f"## {title}", text, shown, f"```sh\n{code}\n```"]
    parts += [f"```text\n{result}\n```" for result in measured]
    return "\n\n".join(parts) + "\n"


def main() -> None:
    data = Path(sys.argv[1]).resolve()
    subprocess.run(["cargo", "build", "--release", "-p", "surfine-cli"], cwd=ROOT, check=True)
    environment = dict(os.environ, PATH=f"{ROOT / 'target/release'}{os.pathsep}{os.environ['PATH']}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "data").symlink_to(data)
        (folder / "butterfly.py").symlink_to(HERE / "butterfly.py")
        sections = [section(*figure, folder, environment) for figure in FIGURES]
    (ROOT / "docs/gallery.md").write_text("\n".join([INTRO, *sections]))


if __name__ == "__main__":
    main()
