"""Lines of overrides: written by hand for each question of the grammar, and drawn at random."""

import random

# Separated by " | " because values may contain spaces.
WRITTEN = """
seed=3
seed=0,1
seed=0,1 | seed=3
seed=0,1 | robot=macro,mini | seed=2,3
robot=macro,mini | noise=none,thesis
robot=glob(m*)
robot=glob(m*,exclude=[meca*,macro])
robot=glob([macro,mini])
robot=glob(q*)
robot=choice(macro,mini)
robot=macro,makro
seed=choice(1,2)
seed=choice(1,2),5
noise=glob(t*),none
seed=range(3)
seed=range(1,9,3)
seed=range(5,0,-2)
seed=range(3,3)
seed=range(0,1,0)
seed=range(0,2.5)
noise.position=range(0,1,0.25)
noise.position=range(0,1,0.1)
noise.position=range(0.1,0.4,0.1)
noise.position=range(0.3,0,-0.1)
controller.period=range(5ms,20ms,5ms)
seed=sort(3,1,2)
seed=sort(3,1,2,reverse=true)
seed=sort(range(1,4),reverse=true)
seed=sort(choice(3,1))
seed=sort(3,a)
controller.period=sort(20ms,5ms,10ms)
controller.period=20ms,5ms,10ms
seed=interval(0,1)
seed=tag(a,choice(1,2))
seed=tag(a,b,range(0,2))
torque_limits.max=[1,2,3],[4,5,6]
torque_limits.max=[[1,2,3],40]
robot.masses={link2:1.5},{link3:0.5}
robot.masses={link2:1.5},{nope:0.5}
robot.masses={link2:1.5} | robot.masses.link2=3,4
robot.masses.link2=3,4 | robot.masses={link2:1.5}
robot.masses={link2:1.5} | robot.masses={link3:0.5} | seed=0,1
robot.name='a,b',c
robot.name=a\\,b,c
robot.name='a b',"c d"
robot.name='it\\'s',b
robot.name=
robot.name=a,
robot.name=,a
robot.name=a b,c
robot.name="\\${seed}",b
duration=null,1
duration=Null
duration=NULL,1
robot.name=~
robot.name=none,on,yes,off
robot.name=on
preset.feedforward=true,false,True
noise.position=1e-3,1E-3
noise.position=.5,1.
noise.position=inf
noise.position=nan
seed=1_000,2
seed=010,0x10
seed=+1
seed=-1,--1
robot.name=1:30
seed=int(1.5),2
seed=int(1.5)
seed=int(1.5,2.5)
noise.position=float(1,2)
robot.name=str(1)
robot.name=str(1),b
robot.name=str(1,2)
robot.name=str([1,2]),b
robot.name=json_str({a:1})
preset.feedforward=bool(1,0)
~noise.position
~noise.position | seed=0,1
~noise
~noise=thesis
~torque_limits
~seed=0
~seed=0,1
~seed=3
~nothing
noise.position=1e-4,1e-3 | ~noise.position
~noise.position | noise.position=1e-4,1e-3
robot.payload={mass:1},{mass:2} | ~robot.payload
+seed=1
++seed=1,2
++seed=1,2 | seed=3
+robot.note=a,b
++robot.note=a,b
robot.note=a,b
nonsense=1,2
noise@other=thesis
+noise@other=thesis,none
noise@noise:other=thesis
experiment=thesis/figure_3_5,thesis/figure_3_9
experiment=[thesis/figure_3_5,thesis/figure_3_9]
experiment=[thesis/figure_3_5],[thesis/figure_3_9]
experiment=sweep/frequency_period | controller.period=0.01
experiment=sweep/frequency_period,sweep/noise_torque_limit
experiment=choice(sweep/frequency_period)
experiment=[sweep/frequency_period,sweep/noise_torque_limit] | torque_limits.max=20 | controller.period=0.01
preset=full_equations,as_reported | seed=0,1
robot=combined | preset=full_equations,as_reported | controller.period.macro=0.01,0.02
trajectory.goal=[0,0,1],${robot.goal}
noise.position=${noise.bias},1 | noise.bias=0,1
noise.position=${nothing}
noise.position=${oc.env:HOME}
robot=mini | robot={settling_band:0.002} | seed=0,1
robot={settling_band:0.002} | robot=mini | seed=0,1
robot=mini,macro | robot={settling_band:0.002}
robot={settling_band:0.002} | robot=mini,macro
noise=thesis | noise={bias:0.1},{bias:0.2}
noise=thesis,{position:1e-4}
noise={position:1e-4},thesis | noise.bias=1,2
noise={position:1e-4} | noise={bias:0.1}
noise={position:1e-4} | noise=thesis | noise.position=2e-4
noise.position=1e-3 | noise={position:2e-3} | noise.position=3e-3
hydra.sweeper.params={seed: '0,1'}
hydra.sweeper.params={seed: '0,1'} | seed=5
hydra.sweeper.params={noise: 'none,thesis'} | noise={bias:0.5}
hydra.sweeper.params={duration: null} | seed=0,1
hydra.sweeper.params={noise: {position: '1e-4,1e-3'}}
hydra.sweeper.params={seed: 3, noise.position: '1e-4,1e-3'} | seed=0,1
"""

_GROUPS = {
    "robot": ("macro", "mini"),
    "noise": ("none", "thesis"),
    "torque_limits": ("none", "thesis"),
    "preset": ("full_equations", "as_reported"),
}
_MAPPINGS = {
    "robot": ("{settling_band:0.002}", "{settling_band:3mm}"),
    "noise": ("{position:1e-4}", "{bias:0.1,position:2e-4}"),
    "torque_limits": ("{max:40}",),
    "preset": ("{feedforward:true}",),
}
_VALUES = {
    "seed": ("0", "3", "7", "010", "1.0"),
    "noise.position": ("1e-4", "1mrad", "0", "null", "${noise.bias}", "1"),
    "noise.bias": ("0.1", "1mrad", "2"),
    "controller.period": ("20ms", "0.01", "0.02", "${robot.period}"),
    "robot.name": ("a", "'a b'", "'c,d'", "yes", "1:30", "str(1)", "null"),
    "torque_limits.max": ("40", "[1,2,3]", "null", "50.0"),
    "robot.payload.mass": ("1", "1.0", "250g"),
}
_FUNCTIONS = {
    "seed": ("range(0,3)", "choice(1,2)", "sort(3,1)", "range(5,0,-2)", "tag(a,choice(4,5))"),
    "noise.position": ("range(0,0.3,0.1)", "choice(1e-4,1e-3)", "sort(2e-3,1e-3)", "range(0.5,2)"),
    "controller.period": ("range(10ms,30ms,10ms)", "sort(20ms,10ms)", "choice(10ms,0.02)"),
}


def written() -> list[tuple[str, ...]]:
    """Return the lines written by hand."""
    return [tuple(line.split(" | ")) for line in WRITTEN.strip().splitlines()]


def drawn(count: int, seed: int) -> list[tuple[str, ...]]:
    """Return random lines of one to four overrides."""
    draw = random.Random(seed)  # noqa: S311 - lines for a comparison
    return [tuple(_override(draw) for _ in range(draw.choice((1, 2, 2, 3, 3, 4)))) for _ in range(count)]


def _override(draw: random.Random) -> str:
    kind = draw.choice(("option", "options", "mapping", "mixed", "value", "values", "values", "function", "gone"))
    group, key = draw.choice([*_GROUPS]), draw.choice([*_VALUES])
    if kind in ("option", "options"):
        return f"{group}={','.join(draw.sample(_GROUPS[group], 1 + (kind == 'options')))}"
    if kind in ("mapping", "mixed"):
        mapping = draw.choice(_MAPPINGS[group])
        return f"{group}={mapping}" if kind == "mapping" else f"{group}={draw.choice(_GROUPS[group])},{mapping}"
    if kind == "function":
        key = draw.choice([*_FUNCTIONS])
        return f"{key}={draw.choice(_FUNCTIONS[key])}"
    if kind == "gone":
        return f"~{draw.choice(('noise.position', 'noise.bias', 'torque_limits', 'robot.payload', 'seed'))}"
    sign = draw.choice(("", "", "", "", "++"))
    return f"{sign}{key}={','.join(draw.sample(_VALUES[key], 1 if kind == 'value' else 2))}"
