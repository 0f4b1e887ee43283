"""Physics modules, whose content is part of every run hash.

A module counts if a number of a run follows from it: it reads the resolved config (`config`), builds robot, path,
control law, plant and sensors (`assembly`), simulates, calibrates or measures. Other modules are left out. Some compose
the resolved config, which the hash contains. Some only reject, report or store something. The rest use finished runs:
caveat rules, statistics, store, reports, commands.

Each module has an id, by default its name. After a move or a renaming, keep the id by a row of the table: no hash
changes.
"""

import ast
import hashlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from runner.base.cache import read_answer, write_answer
from runner.base.paths import package_dir
from runner.store import syntax

# Folders and their modules. A module's id follows "="; without "=" it is the module's name. "*" means all modules of
# the folder, except one after "-".
_TABLE = """
    assembly: arms assemble=assembly closed_loop=loop.closed_loop cross_checks desired_motion drawn_loops flexibility
        input_shaping run_config=run timing validation wall=loop.wall
    assembly/compiled: *
    base: portable trace
    calibration: * __init__=calibration.__init__ gravity=calibration.gravity
        tool_centre_point=calibration.tool_centre_point tool_direction=calibration.tool_direction
        uncertainty=repeatability
    caveats: integration_error=plant_error rounding_growth=rounding
    config: calibration groups input_shaper parsing robot=config.robot robot_files settings torque_limits
    controllers: * -stability __init__=controllers.__init__ controller=controllers.controller
        disturbance_observer=controllers.disturbance_observer notch=controllers.notch
    controllers/force: * force_reading=controllers.force_reading
    controllers/joint_space: *
    controllers/kinematic: *
    controllers/macro_mini: *
    controllers/operational_space: *
    environments: * __init__=environments.__init__ external_wrench=interaction
    metrics: * __init__=metrics.__init__ contact=metrics.contact
    plants: * -agreement __init__=plants.__init__ compiled_motion=compiled.motion computation=plants.computation
        flexibility=plants.flexibility flexible_joints=plants.flexible_joints plant=plants.plant wrappers=touched
    plugins: features guard metric_units registry
    robots: * __init__=robots.__init__ robot=robots.robot
    schema: values
    sensing: * __init__=sensing.__init__ endpoint=sensing.endpoint
    simulation: batch by_ticks calibration=calibration_job calibration_config=checked_calibration contact=loop.contact
        loop=simulation recorder results run=job sensors
    symbolic: * maths=controllers.maths vectors=compiled.vectors
    trajectories: * __init__=trajectories.__init__ joint_motion=trajectories.joint_motion
        trajectory=trajectories.trajectory
"""  # fmt: skip


def module_ids() -> dict[str, str]:
    """Return the id of each physics module by its file in the package, such as "robots/vibration.py"."""
    ids: dict[str, str] = {}
    folder = ""
    for word in _TABLE.split():
        name, _, own = word.partition("=")
        if word.endswith(":"):
            folder = "" if word == ".:" else f"{word[:-1]}/"
        elif word == "*":
            modules = sorted(path.stem for path in (package_dir() / folder).glob("*.py"))
            ids |= {f"{folder}{module}.py": module for module in modules if module != "__init__"}
        elif word.startswith("-"):
            del ids[f"{folder}{word[1:]}.py"]
        else:
            ids[f"{folder}{name}.py"] = own or name
    return ids


@cache
def physics_digest() -> str:
    """Return a digest of the content of the physics, the same on every Python version."""
    ids, root = module_ids(), package_dir()
    sources = {_dotted(file): (root / file).read_bytes() for file in ids}
    return content_digest(sources, {_dotted(file): own for file, own in ids.items()})


def content_digest(sources: Mapping[str, bytes], ids: Mapping[str, str]) -> str:
    """Return a digest of the content of modules, computed once and kept in the user's cache folder.

    Args:
        sources: Source of each module, by the name under which others import it.
        ids: Id of each module, by the same name.
    """
    state = hashlib.sha256(Path(__file__).read_bytes() + Path(syntax.__file__).read_bytes())
    for name, source in sources.items():
        state.update(b"%b\0%d\0%b" % (f"{name} {ids[name]}".encode(), len(source), source))
    key = f"content-{state.hexdigest()}"
    found = read_answer(key)
    if not isinstance(found, str):
        found = _digest({name: _parsed(source) for name, source in sources.items()}, ids)
        write_answer(key, found)
    return found


def _digest(trees: Mapping[str, ast.Module], ids: Mapping[str, str]) -> str:
    bound = {own: {name: (module, of) for name, module, of in syntax.imports(tree)} for own, tree in trees.items()}

    def resolve(module: str, name: str) -> str:
        """Return the id of the module that defines a name, and the name in that module."""
        whole = f"{module}.{name}" if name else module
        if whole in ids:
            return ids[whole]
        if module not in ids:
            return name or module
        return resolve(*bound[module][name]) if name in bound[module] else f"{ids[module]}:{name}"

    digest = hashlib.sha256()
    for name in sorted(trees, key=ids.__getitem__):
        text = syntax.content(trees[name], resolve)
        if text:  # otherwise it only re-exports its imports
            digest.update(f"{ids[name]}\0{len(text)}\0{text}".encode())
    return digest.hexdigest()


def _parsed(source: bytes) -> ast.Module:
    """Return the syntax tree of a module; if this Python cannot parse it, a tree with the source as a constant."""
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.Module([ast.Expr(ast.Constant(source))], [])


def _dotted(file: str) -> str:
    return f"runner/{file}".removesuffix(".py").removesuffix("/__init__").replace("/", ".")
