"""Physics modules, whose content is part of every run hash.

A module counts if a number of a run follows from it: it reads the resolved config (`config`), builds robot, path,
control law, plant and sensors (`assembly`), simulates, calibrates or measures. Other modules are left out. Some compose
the resolved config, which the hash contains. Some only reject, report or store something. The rest use finished runs:
caveat rules, statistics, store, reports, commands.

Each module has an id. After a move, change the module's folder in the table and keep its id: no hash changes.
"""

import ast
import hashlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from runner.base.cache import read_answer, write_answer
from runner.base.paths import package_dir
from runner.store import syntax

# Folders and their modules. A module's id follows "="; without "=" it is the module's name.
_TABLE = """
    assembly: arms assemble=assembly closed_loop=loop.closed_loop cross_checks desired_motion drawn_loops flexibility
        input_shaping run_config=run timing validation wall=loop.wall
    assembly/compiled: commands law loop_program loops
    base: portable trace
    calibration: __init__=calibration.__init__ gravity=calibration.gravity orientations procedure
        tool_centre_point=calibration.tool_centre_point tool_direction=calibration.tool_direction
        uncertainty=repeatability weighing
    caveats: integration_error=plant_error rounding_growth=rounding
    config: calibration groups input_shaper parsing robot=config.robot robot_files settings torque_limits
    controllers: __init__=controllers.__init__ controller=controllers.controller
        disturbance_observer=controllers.disturbance_observer notch=controllers.notch torque_filter torque_law
    controllers/force: admittance admittance_filter force_reading=controllers.force_reading hybrid_force impedance
        tip_force
    controllers/joint_space: adaptive computed_torque function_law iterative_learning joint_law joint_pd joint_pid
        motor_pd passivity sliding_mode
    controllers/kinematic: differential_inverse_kinematics limited_motion resolved_rate
    controllers/macro_mini: inertial_damping macro_mini stage_loops
    controllers/operational_space: operational_space tip_task whole_body
    environments: __init__=environments.__init__ external_wrench=interaction free hand push wall
    metrics: __init__=metrics.__init__ contact=metrics.contact effort family positioning reaching summary tracking
    plants: __init__=plants.__init__ bullet bullet_engine bullet_links bullet_servers compiled_bullet
        compiled_motion=compiled.motion computation=plants.computation decoupled flexibility=plants.flexibility
        flexible_config flexible_joints=plants.flexible_joints friction friction_law kinematic motor_limits mujoco
        plant=plants.plant rk4 rk4_flexible_links runge_kutta servo stepped_bullet whole_motion wrappers=touched
    plugins: features guard metric_units registry
    robots: __init__=robots.__init__ canonical description drawn elements file_extensions inertials
        inverse_kinematics joint_dynamics mismatch mjcf mjcf_files mjcf_motors mjcf_urdf model mounting
        robot=robots.robot task_space tree vibration workspace
    schema: values
    sensing: __init__=sensing.__init__ encoders endpoint=sensing.endpoint force_torque joint_torque streams velocity
        wrench
    simulation: batch by_ticks calibration=calibration_job calibration_config=checked_calibration contact=loop.contact
        loop=simulation recorder results run=job sensors
    symbolic: algebra arm backend bullet_step code engine expression maths=controllers.maths program regressor structure
        tangent vectors=compiled.vectors
    trajectories: __init__=trajectories.__init__ circle from_file geometry goal joint_motion=trajectories.joint_motion
        joint_quintic joint_sinusoids joint_waypoints line lissajous motion quintic shaped splines square
        trajectory=trajectories.trajectory waypoints
"""  # fmt: skip


def module_ids() -> dict[str, str]:
    """Return the id of each physics module by its file in the package, such as "robots/vibration.py"."""
    ids, folder = {}, ""
    for word in _TABLE.split():
        name, _, own = word.partition("=")
        if word.endswith(":"):
            folder = "" if word == ".:" else f"{word[:-1]}/"
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
