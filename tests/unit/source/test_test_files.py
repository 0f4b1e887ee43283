"""Each module of physics, statistics, store and config has a test file of its name, or shares one."""

from pathlib import Path

import pytest

from runner.base.paths import package_dir

TESTS = Path(__file__).resolve().parents[2]
PACKAGES = [
    "assembly",
    "calibration",
    "caveats",
    "config",
    "controllers",
    "environments",
    "metrics",
    "plants",
    "robots",
    "schema",
    "sensing",
    "simulation",
    "statistics",
    "store",
    "symbolic",
    "trajectories",
]
NAMES = {path.name for path in TESTS.rglob("test_*.py")}
MODULES = [
    path.relative_to(package_dir()).with_suffix("").as_posix()
    for package in PACKAGES
    for path in sorted((package_dir() / package).rglob("*.py"))
    if path.name != "__init__.py"
]
SHARED = {
    "calibration/procedure": "physics/calibration/test_procedures.py",
    "calibration/weighing": "physics/calibration/test_procedures.py",
    "config/composed": "contract/config/test_compose.py",
    "config/compose/given_keys": "contract/assembly/test_dependent_keys.py",
    "config/calibration": "contract/calibration/test_calibration_job.py",
    "config/input_shaper": "unit/assembly/test_input_shaping.py",
    "config/robot_files": "contract/config/test_units_of_keys.py",
    "config/limits": "contract/assembly/test_run_cost.py",
    "simulation/calibration_config": "contract/calibration/test_calibration_job.py",
    "assembly/versions": "contract/store/test_identity.py",
    "assembly/wall": "physics/caveats/test_servo_contact_stability.py",
    "config/compose/files": "contract/config/test_options.py",
    "config/compose/composition_errors": "contract/config/test_compose.py",
    "config/compose/messages": "contract/assembly/test_validation.py",
    "assembly/cross_checks": "unit/assembly/test_controller_wrappers.py",
    "assembly/flexibility": "physics/simulation/test_flexible_runs.py",
    "config/groups": "contract/assembly/test_validation.py",
    "config/robot": "contract/config/test_stage_defaults.py",
    "assembly/run_config": "contract/assembly/test_validation.py",
    "config/settings": "contract/assembly/test_validation.py",
    "config/torque_limits": "unit/assembly/test_joints.py",
    "controllers/joint_space/joint_law": "physics/controllers/test_joint_laws.py",
    "controllers/joint_space/motor_pd": "physics/controllers/test_joint_laws.py",
    "controllers/macro_mini/inertial_damping": "physics/controllers/test_macro_mini.py",
    "controllers/macro_mini/stage_loops": "physics/controllers/test_macro_mini.py",
    "controllers/stability": "physics/controllers/test_force_stability.py",
    "controllers/torque_filter": "physics/controllers/test_disturbance_observer.py",
    "environments/free": "physics/environments/test_environments.py",
    "environments/hand": "physics/environments/test_environments.py",
    "environments/push": "physics/environments/test_environments.py",
    "environments/wall": "physics/environments/test_environments.py",
    "statistics/conclusion": "unit/statistics/test_scope.py",
    "caveats/plant_error": "physics/caveats/test_plant_error_caveat.py",
    "caveats/integration_error": "physics/simulation/test_plant_error.py",
    "caveats/versions": "physics/caveats/test_monitor.py",
    "caveats/setting": "physics/caveats/test_monitor.py",
    "metrics/family": "contract/plugins/test_metrics.py",
    "symbolic/backend": "physics/symbolic/test_law.py",
    "plants/flexible_config": "physics/plants/test_flexible_joints.py",
    "plants/rk4_flexible_links": "physics/plants/test_flexible_links.py",
    "assembly/engine_check": "physics/plants/test_agreement_of_files.py",
    "robots/canonical": "physics/robots/test_unusual_files.py",
    "robots/elements": "physics/robots/test_urdf_values.py",
    "robots/file_extensions": "physics/robots/test_unusual_files.py",
    "robots/mjcf_motors": "physics/robots/test_mjcf_joints.py",
    "robots/mjcf_urdf": "physics/robots/test_mjcf.py",
    "sensing/endpoint": "physics/simulation/test_endpoint_sensing.py",
    "schema/units": "contract/config/test_units_of_keys.py",
    "plants/bullet_engine": "physics/plants/test_bullet.py",
    "plants/flexibility": "physics/plants/test_flexible_joints.py",
    "plants/bullet_links": "physics/plants/test_bullet_step.py",
    "plants/compiled_bullet": "physics/plants/test_bullet_step.py",
    "plants/stepped_bullet": "physics/plants/test_bullet_step.py",
    "plants/whole_motion": "physics/symbolic/test_tick.py",
    "assembly/assemble": "physics/simulation/test_simulation.py",
    "simulation/by_ticks": "physics/simulation/test_bullet_runs.py",
    "assembly/drawn_loops": "physics/robots/test_drawn.py",
    "assembly/closed_loop": "physics/simulation/test_simulation.py",
    "assembly/compiled/loop_program": "physics/symbolic/test_tick.py",
    "assembly/compiled/commands": "physics/symbolic/test_law.py",
    "assembly/compiled/loops": "physics/symbolic/test_law.py",
    "simulation/contact": "physics/caveats/test_servo_contact_stability.py",
    "simulation/loop": "physics/simulation/test_simulation.py",
    "simulation/provenance": "contract/store/test_store.py",
    "simulation/calibration": "contract/calibration/test_calibration_job.py",
    "simulation/run": "physics/simulation/test_blocks.py",
    "simulation/tick_time": "contract/sweeps/test_estimates_of_sweeps.py",
    "simulation/sensors": "physics/simulation/test_endpoint_sensing.py",
    "store/cells": "contract/cli/test_check_sweep.py",
    "store/calibration": "contract/calibration/test_calibration_job.py",
    "store/finished": "contract/sweeps/test_outcomes.py",
    "store/physics": "unit/store/test_physics_modules.py",
    "store/opening": "contract/store/test_kinds.py",
    "store/run": "contract/store/test_runs.py",
    "store/sweep": "contract/store/test_sweep_store.py",
    "symbolic/arm": "physics/symbolic/test_algebra.py",
    "symbolic/program": "physics/symbolic/test_code.py",
    "symbolic/vectors": "physics/symbolic/test_algebra.py",
    "symbolic/regressor": "physics/symbolic/test_algebra.py",
    "symbolic/structure": "physics/symbolic/test_law.py",
    "trajectories/splines": "physics/trajectories/test_waypoints.py",
}
"""Test file of each module that has none of its name: that of the module to which it belongs."""


@pytest.mark.parametrize("module", MODULES)
def test_every_module_has_a_test_file(module):
    own = f"test_{module.rpartition('/')[2]}.py"
    assert own in NAMES or module in SHARED, f"{module}: write {own}, or name in SHARED the file that it shares"


@pytest.mark.parametrize("module", SHARED)
def test_shared_test_files_exist(module):
    assert module in MODULES
    assert (TESTS / SHARED[module]).is_file()
