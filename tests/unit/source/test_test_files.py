"""Each module of physics, statistics, store and config has a test file of its name, or shares one."""

from pathlib import Path

import pytest

from runner.base.paths import package_dir

TESTS = Path(__file__).resolve().parents[2]
PACKAGES = [
    "calibration",
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
    "calibration/procedures/bench": "physics/calibration/test_procedures.py",
    "calibration/procedures/procedure": "physics/calibration/test_procedures.py",
    "calibration/procedures/touching": "physics/calibration/test_procedures.py",
    "config/arms": "physics/robots/test_zoo.py",
    "config/calibration": "physics/calibration/test_procedures.py",
    "config/caveats": "physics/metrics/test_watch.py",
    "config/compose/composition_errors": "contract/config/test_composing_once.py",
    "config/compose/data_files": "contract/config/test_no_code.py",
    "config/compose/hydra_config": "contract/config/test_composing_once.py",
    "config/compose/messages": "contract/config/test_overrides.py",
    "config/compose/problems": "contract/config/test_validation.py",
    "config/compose/stage_defaults": "contract/config/test_stages.py",
    "config/computation": "contract/config/test_validation.py",
    "config/endpoint_sensor": "physics/simulation/test_endpoint_sensing.py",
    "config/force_reading": "physics/sensing/test_joint_torque.py",
    "config/groups": "contract/config/test_validation.py",
    "config/input_shaper": "physics/simulation/test_shaped_runs.py",
    "config/noise": "contract/config/test_validation.py",
    "config/parsing": "contract/config/test_validation.py",
    "config/payload": "physics/simulation/test_payload_schedule.py",
    "config/plugged": "contract/plugins/test_sensors.py",
    "config/preset": "contract/config/test_options.py",
    "config/reach": "physics/simulation/test_feasibility.py",
    "config/repeats": "contract/config/test_validation.py",
    "config/robot": "contract/config/test_robot_defaults.py",
    "config/settings": "contract/config/test_validation.py",
    "config/spec": "contract/config/test_spec_config.py",
    "config/start": "contract/config/test_validation.py",
    "config/sweep": "contract/config/test_sweep_experiments.py",
    "config/timing": "contract/config/test_validation.py",
    "config/torque_limits": "contract/config/test_stages.py",
    "controllers/force/force_reading": "physics/controllers/test_hybrid_force.py",
    "controllers/graph": "unit/reporting/test_drawings.py",
    "controllers/joint_space/joint_law": "physics/controllers/test_joint_laws.py",
    "controllers/joint_space/motor_pd": "physics/controllers/test_joint_laws.py",
    "controllers/kinds": "physics/controllers/test_controller_kinds.py",
    "controllers/macro_mini/inertial_damping": "physics/controllers/test_macro_mini.py",
    "controllers/macro_mini/stage_law": "physics/controllers/test_macro_mini.py",
    "environments/external_wrench": "physics/environments/test_link_forces.py",
    "environments/free": "physics/environments/test_environments.py",
    "environments/hand": "physics/environments/test_environments.py",
    "environments/push": "physics/environments/test_environments.py",
    "environments/wall": "physics/environments/test_environments.py",
    "metrics/caveats/caveat": "physics/metrics/test_watch.py",
    "metrics/caveats/default_plant": "physics/metrics/test_watch.py",
    "metrics/caveats/file": "physics/metrics/test_robot_file_caveat.py",
    "metrics/caveats/rule": "physics/metrics/test_watch.py",
    "metrics/caveats/setting": "physics/metrics/test_watch.py",
    "metrics/caveats/today": "physics/metrics/test_watch.py",
    "metrics/context": "unit/metrics/test_summary.py",
    "metrics/family": "unit/metrics/test_summary.py",
    "plants/flexible_config": "physics/plants/test_flexible_joints.py",
    "plants/kinds": "physics/plants/test_plant_kinds.py",
    "plants/mujoco_model": "physics/plants/test_mujoco.py",
    "plants/rk4_flexible_links": "physics/plants/test_flexible_links.py",
    "robots/cantilever": "physics/robots/test_beams.py",
    "robots/mjcf_urdf": "physics/robots/test_mjcf.py",
    "sensing/endpoint": "physics/simulation/test_endpoint_sensing.py",
    "sensing/kinds": "physics/sensing/test_force_torque.py",
    "simulation/assembly": "physics/simulation/test_simulation.py",
    "simulation/closed_loop": "physics/simulation/test_simulation.py",
    "simulation/command": "physics/simulation/test_command_delay.py",
    "simulation/compiled/closed_loop": "physics/symbolic/test_tick.py",
    "simulation/compiled/commands": "physics/symbolic/test_law.py",
    "simulation/compiled/compile": "physics/symbolic/test_tick.py",
    "simulation/compiled/maths": "physics/symbolic/test_law.py",
    "simulation/compiled_loop": "physics/symbolic/test_tick.py",
    "simulation/drive": "physics/simulation/test_joint_runs.py",
    "simulation/endpoint": "physics/simulation/test_endpoint_sensing.py",
    "simulation/failures": "physics/simulation/test_simulation.py",
    "simulation/joint_torques": "physics/sensing/test_joint_torque.py",
    "simulation/loop": "physics/simulation/test_simulation.py",
    "simulation/provenance": "contract/store/test_store.py",
    "simulation/recorder": "physics/simulation/test_simulation.py",
    "simulation/result": "physics/simulation/test_batch_jobs.py",
    "simulation/walls": "physics/environments/test_environments.py",
    "statistics/permutation": "unit/statistics/test_effects.py",
    "statistics/spec/history": "unit/statistics/test_spec_verdict.py",
    "store/calibration": "contract/calibration/test_calibration_job.py",
    "store/finer": "contract/sweeps/test_finer_step.py",
    "store/finished": "contract/store/test_runs.py",
    "store/json_texts": "contract/store/test_batch_records.py",
    "store/recall/basis": "contract/store/test_runs.py",
    "store/record": "contract/store/test_store.py",
    "store/references/learned": "contract/store/test_reference.py",
    "store/references/shipped": "contract/store/test_reference.py",
    "store/seal": "contract/store/test_damage.py",
    "store/stored": "contract/store/test_store.py",
    "store/sweep": "contract/store/test_sweep_store.py",
    "store/values": "contract/store/test_sweep_store.py",
    "store/writing": "contract/store/test_batch_records.py",
    "symbolic/arm": "physics/symbolic/test_algebra.py",
    "symbolic/end_points": "physics/symbolic/test_tick.py",
    "symbolic/program": "physics/symbolic/test_code.py",
    "symbolic/regressor": "physics/symbolic/test_algebra.py",
    "symbolic/structure": "physics/symbolic/test_law.py",
    "trajectories/kinds": "physics/trajectories/test_trajectory_kinds.py",
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
