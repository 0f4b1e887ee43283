"""Makes the report of the site's gallery in build/gallery: `python -m tools.docs.gallery`; `make docs` runs it."""

import shutil
from pathlib import Path

import runner

FOLDER = Path(__file__).resolve().parents[2] / "build" / "gallery"
OVERRIDES = (
    "plant=rk4",
    "robot=planar",
    "trajectory=quintic",
    "noise.position=1e-4",
    "noise.velocity=finite_difference",
    "mismatch=sampled",
    "repetitions=20",
)
CONTROLLERS = ["computed_torque", "passivity"]


def main() -> None:
    """Make what is missing of the sweep, and write its report."""
    sweep = runner.sweep(*OVERRIDES, controller=CONTROLLERS, outputs=FOLDER / "outputs", workers=0)
    made = runner.report(sweep, formats="html").html
    assert made is not None  # as it was asked for
    shutil.copyfile(made, FOLDER / "report.html")
    print(FOLDER / "report.html")


if __name__ == "__main__":
    main()
