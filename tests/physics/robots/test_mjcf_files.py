"""Files of an MJCF: includes and meshes that are missing, outside or not of an arm are refused."""

import pytest
from support.mjcf_arms import CHAIN, written

from runner.base.errors import ConfigError
from runner.robots.mjcf import read_mjcf

MESH = CHAIN.replace("<worldbody>", '<asset><mesh name="m" file="FILE"/></asset><worldbody>').replace(
    '<geom fromto="0 0 0 0.2 0 0"/>', '<geom type="mesh" mesh="m"/>'
)
INERTIAL = '<inertial mass="1" pos="0 0 0" diaginertia="0.1 0.1 0.1"/>'


def refused(path):
    with pytest.raises(ConfigError) as error:
        read_mjcf(path)
    (problem,) = error.value.problems
    return problem


def test_a_missing_mesh_that_weighs_is_refused(tmp_path):
    path = written(tmp_path, MESH.replace("FILE", "hand.stl"))
    assert refused(path) == f"robot.mjcf: {path} names the mesh 'hand.stl': no such file; put it there, or take it out"


@pytest.mark.parametrize("name", ["hand.stl", "../hand.stl"])
def test_one_of_a_body_with_an_inertial_is_no_bar(tmp_path, name):
    (tmp_path / "hand.stl").touch()
    text = MESH.replace("FILE", name).replace('<joint name="q3"', f'{INERTIAL}<joint name="q3"')
    path = written(tmp_path, text, "a/arm.xml")
    assert read_mjcf(path).files == (path,)
    assert f"meshes that are not in its folder, and weigh nothing: '{name}'" in read_mjcf(path).left_out.rest


@pytest.mark.parametrize("name", ["../secret.obj", "/etc/passwd"])
@pytest.mark.parametrize("compiler", ["", 'meshdir="meshes"', 'assetdir=".."'])
def test_meshes_outside_the_folder_are_refused(tmp_path, name, compiler):
    written(tmp_path, "v 0 0 0", "secret.obj")
    text = MESH.replace("FILE", name).replace('angle="degree"', f'angle="degree" {compiler}')
    text = text.replace('assetdir=".."', 'assetdir="../.."')
    path = written(tmp_path, text, "a/arm.xml")
    told = refused(path)
    assert ("out of the folder a" in told) == (compiler != 'meshdir="meshes"' or name == "/etc/passwd")


@pytest.mark.parametrize("name", ["../part.xml", "/etc/passwd", "sub/../../part.xml"])
def test_includes_outside_the_folder_are_refused(tmp_path, name):
    written(tmp_path, "<mujocoinclude/>", "part.xml")
    path = written(tmp_path, CHAIN.replace("<worldbody>", f'<include file="{name}"/><worldbody>'), "a/arm.xml")
    assert refused(path) == (f"robot.mjcf: {path} includes '{name}': out of the folder a; put it there, or take it out")


def test_a_link_that_leads_out_is_refused(tmp_path):
    written(tmp_path, "<mujocoinclude/>", "part.xml")
    path = written(tmp_path, CHAIN.replace("<worldbody>", '<include file="part.xml"/><worldbody>'), "a/arm.xml")
    (tmp_path / "a" / "part.xml").symlink_to(tmp_path / "part.xml")
    assert "includes 'part.xml': out of the folder a" in refused(path)


def test_an_include_of_an_include_is_followed(tmp_path):
    path = written(tmp_path, CHAIN.replace("<worldbody>", '<include file="sub/a.xml"/><worldbody>'))
    written(tmp_path, '<mujocoinclude><include file="b.xml"/></mujocoinclude>', "sub/a.xml")
    assert "sub/a.xml includes 'b.xml': no such file" in refused(path)
    written(tmp_path, '<mujocoinclude><include file="../../c.xml"/></mujocoinclude>', "sub/b.xml")
    assert "sub/b.xml includes '../../c.xml': out of the folder" in refused(path)


def test_a_file_that_includes_itself_is_refused(tmp_path):
    path = written(tmp_path, CHAIN.replace("<worldbody>", '<include file="arm.xml"/><worldbody>'))
    assert "MuJoCo does not take it: XML Error: File 'arm.xml' already included" in refused(path)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("<robot name='x'/>", "begins with <robot>, not with <mujoco>; a URDF stands at robot.urdf"),
        ("<mujoco", "robot.mjcf: "),
        ("<!DOCTYPE x [<!ENTITY a 'b'>]><mujoco/>", "it has a document type"),
        (f"<mujoco>{300 * '<a>'}{300 * '</a>'}</mujoco>", "its elements stand 301 deep within each other"),
        ('<mujoco><worldbody><replicate count="1000000000"/></worldbody></mujoco>', "holds <replicate>, unknown here"),
        ('<mujoco><worldbody><composite prefix="s"/></worldbody></mujoco>', "holds <composite> 's', unknown here"),
        ('<mujoco><worldbody><flexcomp name="f"/></worldbody></mujoco>', "holds <flexcomp> 'f', unknown here"),
        ('<mujoco><asset><model file="/etc/passwd" name="n"/></asset></mujoco>', "holds <model> 'n', unknown here"),
        ('<mujoco><actuator><plugin plugin="a.b"/></actuator></mujoco>', "holds <plugin> 'a.b', unknown here"),
    ],
)  # fmt: skip
def test_files_that_are_none_of_an_arm_are_refused(tmp_path, text, told):
    assert told in refused(written(tmp_path, text))


@pytest.mark.parametrize("content", ["junk", "", "v 0 0 0\nf 1 2 99\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"])
def test_a_mesh_that_is_none_is_told(tmp_path, content):
    written(tmp_path, content, "m.obj")
    assert "MuJoCo does not take it" in refused(written(tmp_path, MESH.replace("FILE", "m.obj")))


def test_a_mesh_that_weighs_nothing_is_not_read(tmp_path):
    written(tmp_path, "junk", "m.obj")
    text = MESH.replace("FILE", "m.obj").replace('<joint name="q3"', f'{INERTIAL}<joint name="q3"')
    assert "q3" in read_mjcf(written(tmp_path, text)).urdf


HEIGHTS = '<asset><hfield name="h" nrow="{0}" ncol="{1}" size="1 1 1 1"/></asset>'


def with_asset(tmp_path, asset):
    return written(tmp_path, CHAIN.replace("<worldbody>", f"{asset}<worldbody>"))


@pytest.mark.parametrize("rows", ["1000", " +1000 ", "-1000"])
def test_heights_are_counted_before_mujoco_makes_them(tmp_path, rows):
    too_many = with_asset(tmp_path, HEIGHTS.format(rows, 1001))
    assert (
        refused(too_many)
        == f"robot.mjcf: {too_many} has 1,001,000 heights; allowed: up to 1,000,000, with all that it includes"
    )
    assert read_mjcf(with_asset(tmp_path, HEIGHTS.format(1000, 1000))).urdf


def test_heights_of_all_fields_count_together(tmp_path):
    fields = "".join(HEIGHTS.format(900, 900).replace('"h"', f'"h{number}"') for number in range(2))
    assert "has 1,620,000 heights" in refused(with_asset(tmp_path, fields))


@pytest.mark.parametrize(
    ("asset", "told"),
    [
        ("<default>" + '<default class="a"/>' * 3000 + "</default>", "elements; allowed: up to 2,500, with all"),
        ("<!--" + "x" * 5_000_000 + "-->", "bytes; allowed: up to 5,000,000"),
        ('<asset><mesh name="m" builtin="supersphere" params="5000 1 1"/></asset>', "<mesh> 'm', unknown here; write"),
    ],
)
def test_what_mujoco_would_take_much_memory_for_is_refused(tmp_path, asset, told):
    assert told in refused(with_asset(tmp_path, asset))


def test_a_large_mesh_that_weighs_is_refused(tmp_path):
    with (tmp_path / "m.stl").open("wb") as file:
        file.truncate(20_000_001)
    told = "'m.stl': has 20,000,001 bytes; allowed: up to 20,000,000"
    assert told in refused(written(tmp_path, MESH.replace("FILE", "m.stl")))


@pytest.mark.parametrize(
    "size", ['nkey="100000000"', 'nuser_body="100000000"', 'nuserdata="900000000"', 'memory="4000G"']
)
def test_room_that_an_mjcf_asks_for_is_not_made(tmp_path, size):
    assert read_mjcf(with_asset(tmp_path, f"<size {size}/>")).urdf == read_mjcf(with_asset(tmp_path, "")).urdf


def test_a_height_field_that_weighs_is_refused(tmp_path):
    text = CHAIN.replace("<worldbody>", f"{HEIGHTS.format(3, 3)}<worldbody>")
    path = written(tmp_path, text.replace('<geom fromto="0 0 0 0.2 0 0"/>', '<geom type="hfield" hfield="h"/>'))
    assert refused(path).endswith(
        "holds height fields that weigh: 'h'; give their body an <inertial>, or take them out"
    )
