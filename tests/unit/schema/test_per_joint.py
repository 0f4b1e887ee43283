"""Values per joint: one for all or one for each, and a length that does not fit."""

import pytest

from runner.base.errors import ConfigError
from runner.schema.values import expand

JOINTS = ["shoulder", "elbow"]


def test_one_value_counts_for_every_joint():
    assert expand("plant.friction.viscous", 0.5, JOINTS) == [0.5, 0.5]


def test_a_list_is_taken_as_it_is():
    assert expand("plant.friction.viscous", [0.5, 0.7], JOINTS) == [0.5, 0.7]


def test_joints_without_a_name_in_a_mapping_have_zero():
    assert expand("plant.friction.viscous", {"elbow": 0.5}, JOINTS) == [0.0, 0.5]


def test_an_unknown_joint_is_rejected_with_the_nearest():
    with pytest.raises(ConfigError, match=r"a\.key: unknown joint 'elbo'\. Allowed: .* Did you mean 'elbow'\?"):
        expand("a.key", {"elbo": 0.5}, JOINTS)


def test_a_list_of_another_length_names_key_and_joints():
    with pytest.raises(ConfigError, match=r"a\.key: 3 values for 2 joints \(shoulder, elbow\); found"):
        expand("a.key", [1.0, 2.0, 3.0], JOINTS)
