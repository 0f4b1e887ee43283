"""Former names of keys, options, commands, presets and modules."""

# Version 1.0 removes this module, its tests and its imports.

KEYS: dict[str, str] = {
    "plant.parts": "plant.segments",
    "plant.least_inertia": "plant.min_inertia",
    "plant.flexible_joints.braked": "plant.flexible_joints.brake_time",
    "trajectory.start_posture": "trajectory.start_configuration",
    "trajectory.goal_posture": "trajectory.goal_configuration",
    "trajectory.postures": "trajectory.configurations",
    "controller.acts": "controller.actuated_stages",
    "controller.at": "controller.wrench_frame",
    "controller.reading": "controller.force_source",
    "controller.switching": "controller.switching_gain",
    "controller.layer": "controller.boundary_layer",
    "controller.adaptation": "controller.adaptation_gain",
    "controller.cut_off": "controller.cutoff",
    "environment.lasts": "environment.duration",
    "environment.begin": "environment.start_time",
    "environment.travel": "environment.displacement",
}
"""Present name of each former config key, both with their groups."""

VALUES: dict[str, dict[str, str]] = {
    "preset": {"sound": "full_equations"},
    "environment": {"hand": "hand_guiding"},
}
"""Present name of each former option, by config group."""

COMMANDS: dict[str, str] = {
    "diff": "compare",
    "work": "study",
}
"""Present name of each former command."""

TOPICS: dict[str, str] = {
    "references": "baselines",
    "works": "studies",
}
"""Present name of each former topic of `runner list`."""

FILES: dict[str, str] = {
    "work.yaml": "study.yaml",
}
"""Present name of each former file of a study."""

OPTIONS: dict[str, tuple[str, ...]] = {
    "--at-most": ("--max-failure-probability",),
    "--at-once": ("--jobs",),
    "--check": ("--finite-differences",),
    "--html": ("--format html", "--output"),
    "--learn": ("--save-baseline",),
    "--markdown": ("--format markdown",),
    "--metric": ("--metrics",),
    "--of": ("--parameters",),
    "--outputs": ("--output",),
    "--pdf": ("--format pdf",),
    "--reference": ("--baseline",),
    "--write": ("--output",),
}
"""Present spellings of each former option; a command has one of them."""

MODULES: dict[str, str] = {
    "runner.audit": "runner.papers.audit",
    "runner.base.expressions": "runner.papers.expressions",
    "runner.cli.audit": "runner.papers.commands.audit",
    "runner.cli.benchmark": "runner.papers.commands.benchmark",
    "runner.cli.reproduce": "runner.papers.commands.reproduce",
    "runner.cli.study": "runner.papers.commands.study",
    "runner.config.arms": "runner.assembly.arms",
    "runner.config.cross_checks": "runner.assembly.cross_checks",
    "runner.config.dependent_keys": "runner.assembly.dependent_keys",
    "runner.config.desired_motion": "runner.assembly.desired_motion",
    "runner.config.engine_check": "runner.assembly.engine_check",
    "runner.config.flexibility": "runner.assembly.flexibility",
    "runner.config.run": "runner.assembly.run_config",
    "runner.config.timing": "runner.assembly.timing",
    "runner.config.validation": "runner.assembly.validation",
    "runner.doctor.replay": "runner.cli.replay",
    "runner.metrics.caveats": "runner.caveats",
    "runner.metrics.plant_error": "runner.caveats.integration_error",
    "runner.metrics.rounding": "runner.caveats.rounding_growth",
    "runner.plants.servo_contact_stability": "runner.caveats.servo_contact_stability",
    "runner.reporting.audit.forms": "runner.papers.reporting.audit_forms",
    "runner.reporting.audit.report": "runner.papers.reporting.audit_report",
    "runner.reporting.equation": "runner.papers.reporting.equation",
    "runner.reporting.formulas": "runner.reporting.mathml",
    "runner.reporting.published_claims": "runner.papers.reporting.published_claims",
    "runner.simulation.assembly": "runner.assembly.assemble",
    "runner.simulation.closed_loop": "runner.assembly.closed_loop",
    "runner.simulation.compiled": "runner.assembly.compiled",
    "runner.simulation.drawn_loops": "runner.assembly.drawn_loops",
    "runner.store.atomic": "runner.base.atomic",
    "runner.store.writing": "runner.sweeps.records",
    "runner.studies": "runner.papers.studies",
    "runner.study": "runner.papers.study",
    "runner.symbolic.cache": "runner.base.cache",
}
"""Present name of each former module or package."""


def explain_module(name: str) -> str:
    """Return a sentence with the present name of a former module; empty for any other name."""
    former = next((each for each in MODULES if name == each or name.startswith(f"{each}.")), None)
    return f"{former} is now called {MODULES[former]}." if former else ""


def explain_key(key: str) -> str:
    """Return a sentence with the present name of a former key."""
    return f"this key is now called {KEYS[key]}."


def explain_value(group: str, name: str) -> str | None:
    """Return a sentence with the present name of a former option; None for any other name."""
    present = VALUES.get(group, {}).get(name)
    return f"'{name}' is now called '{present}'." if present else None
