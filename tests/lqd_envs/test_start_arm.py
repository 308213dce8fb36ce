import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from lqd_envs import LQDError, ManipulationEnv, ManipulationVectorEnv, ResetError
from lqd_envs.instances import ApproachLimit, Instance
from lqd_envs.scenes.panda import HOME

ID = "LQD/Faucet-v0"
OWN = (0.2, -0.5, 0.1, -2.0, 0.3, 1.0, -0.4)
OTHER = (0.1, -0.4, 0.0, -2.1, 0.0, 0.5, 0.0)
BLOCKED = (0.0, 0.6, 0.0, -2.2, 0.0, 0.33, 0.0)


@pytest.fixture(params=["env", "vector env"])
def make(request):
    """A function that makes an env, single or vectorised, with a start of its own."""
    if request.param == "env":
        return lambda start_arm: ManipulationEnv(start_arm=start_arm)
    return lambda start_arm: ManipulationVectorEnv(2, start_arm=start_arm)


def arms(observation):
    return np.atleast_2d(observation)[:, :7].tolist()


def test_every_reset_starts_there(make):
    env = make(OWN)

    for _ in range(2):
        for start in arms(env.reset()[0]):
            assert start == list(OWN)
    for start in arms(env.reset(options={"arm": OTHER})[0]):
        assert start == list(OTHER)
    for start in arms(env.reset(options={})[0]):
        assert start == list(OWN)


def test_none_is_the_usual_start(make):
    assert all(start == list(HOME) for start in arms(make(None).reset()[0]))


def test_what_the_caller_does_with_it_later_does_not_matter(make):
    own = np.array(OWN)
    env = make(own)
    own[:] = 0.0

    assert all(start == list(OWN) for start in arms(env.reset()[0]))


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_every_autoreset_starts_there(mode):
    envs = ManipulationVectorEnv(2, start_arm=OWN, max_episode_steps=2, autoreset_mode=mode)
    start = envs.reset()[0]
    envs.reset(options={"arm": OTHER})
    envs.step(np.zeros((2, 8)))
    again = envs.step(np.zeros((2, 8)))[0]
    if mode is AutoresetMode.NEXT_STEP:
        again = envs.step(np.zeros((2, 8)))[0]

    assert again.tobytes() == start.tobytes()


def test_instance_that_asks_for_another_start_can_be_met_in_every_episode():
    sideways = Instance(ID, approach=ApproachLimit((0.0, 1.0, -0.2), 0.9))
    facing = (0.0, -0.3, 0.0, -2.2, 0.0, 0.33, 0.0)

    def fingers(start_arm):
        env = gym.make(ID, instance=sideways, start_arm=start_arm).unwrapped
        env.reset()
        columns = env._observe(env._start_sensordata)[1]
        return bool(sideways.approach.holds(columns)[0])

    assert not fingers(facing)
    assert fingers((0.8, -0.5, 0.3, -1.8, 1.2, 1.0, 0.0))


def test_goes_through_the_spec():
    env = gym.make(ID, start_arm=OWN)
    again = gym.make(env.spec)

    assert again.reset()[0].tobytes() == env.reset()[0].tobytes()


@pytest.mark.parametrize(
    ("start_arm", "text"),
    [
        (
            HOME[:6],
            r"expected start_arm to be 7 finite joint positions in rad, or None, got \(0\.0",
        ),
        (np.zeros((2, 7)), r"in rad, or None, got float64 array of shape \(2, 7\)$"),
        ("abc", r"in rad, or None, got 'abc'$"),
        ((*HOME[:6], np.nan), r"7 finite joint positions in rad, or None, got"),
        ((*HOME[:6], 10**400), r"7 finite joint positions in rad, or None, got"),
        (
            (0.0, -0.3, 0.0, -0.2, 0.0, 0.33, 0.0),
            r"expected arm joint 4 of start_arm within \[-3\.0718, -0\.4000\] rad, got -0\.2000$",
        ),
    ],
)
def test_wrong_start_is_refused_at_once(make, start_arm, text):
    with pytest.raises(LQDError, match=text):
        make(start_arm)


def test_blocked_usual_start_says_what_to_do(make):
    env = make(BLOCKED)
    text = (
        r"got the usual one with its hand, its fingers or link 6 or 7 inside the table, the object "
        r"or an obstacle, .*: give another as the argument `start_arm`, or to a reset as the "
        r"option `arm`$"
    )

    with pytest.raises(ResetError, match=text):
        env.reset()
    env.reset(options={"arm": OWN})


def test_blocked_autoreset_says_what_to_do():
    envs = ManipulationVectorEnv(2, start_arm=BLOCKED, max_episode_steps=1)
    envs.reset(options={"arm": OWN})
    envs.step(np.zeros((2, 8)))

    with pytest.raises(ResetError, match=r"got the usual one .* in envs 0, 1: give another as"):
        envs.step(np.zeros((2, 8)))
