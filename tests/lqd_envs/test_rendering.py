import ctypes
import os
import subprocess
import sys
import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import RecordVideo

from lqd_envs import ManipulationEnv, RenderingError
from lqd_envs.rendering_backend import choose_headless_backend, has_display

WITHOUT_OPENGL = """
import numpy as np

import lqd_envs

trajectories = lqd_envs.rollout("LQD/Faucet-v0", np.array([[0, -0.8, 1, 0, 0, 0, 0, 0.6, 0.3]]))
assert trajectories.verdicts.tolist() == [lqd_envs.Verdict.VALID]
env = lqd_envs.ManipulationEnv(render_mode="rgb_array")
env.reset()
env.step(np.zeros(8))
try:
    env.render()
except lqd_envs.RenderingError as error:
    print(error)
env.close()
"""


@pytest.fixture(scope="module")
def picture_env():
    """An env that can draw, where there is OpenGL."""
    env = ManipulationEnv(render_mode="rgb_array", width=160, height=120)
    env.reset()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # GLFW warns before MuJoCo fails
        try:
            env.render()
        except RenderingError as error:
            pytest.skip(str(error))
    yield env
    env.close()


def test_picture_has_the_size_and_shows_something(picture_env):
    picture_env.reset()

    picture = picture_env.render()

    assert picture.shape == (120, 160, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 10.0
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 100


def test_picture_changes_as_the_robot_moves(picture_env):
    picture_env.reset()
    before = picture_env.render()
    for _ in range(10):
        picture_env.step(np.ones(8))

    after = picture_env.render()

    assert (before != after).any()
    picture_env.reset()
    assert np.array_equal(picture_env.render(), before)


def test_drawing_does_not_change_the_simulation(picture_env):
    def run(*, draw):
        picture_env.reset()
        for _ in range(5):
            observation, *_ = picture_env.step(np.full(8, 0.3))
            if draw:
                picture_env.render()
        return observation.tobytes()

    assert run(draw=True) == run(draw=False)


@pytest.mark.usefixtures("picture_env")
def test_pictures_go_on_after_close():
    env = ManipulationEnv(render_mode="rgb_array", width=64, height=48)
    env.reset()
    first = env.render()
    env.close()

    again = env.render()

    env.close()
    env.close()
    assert again.shape == (48, 64, 3)
    assert np.array_equal(first, again)


def test_nothing_is_drawn_without_a_render_mode():
    env = ManipulationEnv()
    env.reset()

    assert env.render() is None


@pytest.fixture
def no_display(monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    return monkeypatch


@pytest.mark.usefixtures("no_display")
def test_window_without_a_display_is_refused():
    env = ManipulationEnv(render_mode="human")
    text = (
        r'expected a display for render_mode="human", got none \(DISPLAY and WAYLAND_DISPLAY are '
        r'not set\): use render_mode="rgb_array", or run where there is a screen'
    )

    with pytest.raises(RenderingError, match=text):
        env.reset()
    with pytest.raises(RenderingError, match=text):
        env.render()
    with pytest.raises(RenderingError, match=text):
        env.step(np.zeros(8))
    env.close()


@pytest.mark.usefixtures("no_display")
@pytest.mark.parametrize(
    ("platform", "variables", "display"),
    [
        ("linux", {}, False),
        ("linux", {"DISPLAY": ""}, False),
        ("linux", {"DISPLAY": ":0"}, True),
        ("linux", {"WAYLAND_DISPLAY": "wayland-0"}, True),
        ("darwin", {}, True),
    ],
)
def test_display_is_found_by_the_environment(monkeypatch, platform, variables, display):
    monkeypatch.setattr(sys, "platform", platform)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)

    assert has_display() is display


@pytest.fixture
def bare(no_display):
    """No display, no chosen backend, and EGL installed."""
    # Set before it is deleted, so that it is restored whatever is under test does to it.
    no_display.setenv("MUJOCO_GL", "")
    no_display.delenv("MUJOCO_GL")
    no_display.setattr(ctypes, "CDLL", lambda name: name)


@pytest.mark.usefixtures("bare")
def test_egl_is_chosen_without_a_display():
    choose_headless_backend()

    assert os.environ["MUJOCO_GL"] == "egl"


@pytest.mark.usefixtures("bare")
@pytest.mark.parametrize("display", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_nothing_is_chosen_with_a_display(monkeypatch, display):
    monkeypatch.setenv(display, ":0")

    choose_headless_backend()

    assert "MUJOCO_GL" not in os.environ


@pytest.mark.usefixtures("bare")
def test_empty_display_is_none(monkeypatch):
    monkeypatch.setenv("DISPLAY", "")

    choose_headless_backend()

    assert os.environ["MUJOCO_GL"] == "egl"


@pytest.mark.usefixtures("bare")
@pytest.mark.parametrize("chosen", ["osmesa", "glfw", "disable", ""])
def test_choice_of_the_user_is_kept(monkeypatch, chosen):
    monkeypatch.setenv("MUJOCO_GL", chosen)

    choose_headless_backend()

    assert os.environ["MUJOCO_GL"] == chosen


@pytest.mark.usefixtures("bare")
@pytest.mark.parametrize("platform", ["darwin", "win32"])
def test_nothing_is_chosen_on_other_platforms(monkeypatch, platform):
    monkeypatch.setattr(sys, "platform", platform)

    choose_headless_backend()

    assert "MUJOCO_GL" not in os.environ


@pytest.mark.usefixtures("bare")
def test_nothing_is_chosen_where_egl_is_missing(monkeypatch):
    def missing(name):
        raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr(ctypes, "CDLL", missing)

    choose_headless_backend()

    assert "MUJOCO_GL" not in os.environ


@pytest.mark.usefixtures("bare")
def test_nothing_is_chosen_where_egl_has_no_opengl_beside_it(monkeypatch):
    def only_egl(name):
        if "EGL" not in name:
            raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr(ctypes, "CDLL", only_egl)

    choose_headless_backend()

    assert "MUJOCO_GL" not in os.environ


def test_warnings_as_errors_leave_the_rendering_error_alone():
    without_display = {
        name: value
        for name, value in os.environ.items()
        if name not in ("DISPLAY", "WAYLAND_DISPLAY")
    }
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", WITHOUT_OPENGL],
        env={**without_display, "MUJOCO_GL": "glfw"},
        capture_output=True,
        text=True,
        check=True,
    )

    assert result.stdout.startswith("expected OpenGL to draw a picture with")


def test_everything_but_pictures_works_without_opengl():
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", WITHOUT_OPENGL],
        env={**os.environ, "MUJOCO_GL": "disable"},
        capture_output=True,
        text=True,
        check=True,
    )

    assert result.stdout.startswith("expected OpenGL to draw a picture with, but MuJoCo could not")
    assert "MUJOCO_GL='disable'" in result.stdout
    assert "install EGL (on Debian and Ubuntu `apt-get install libegl1 libgl1`)" in result.stdout
    assert result.stderr == ""


@pytest.mark.usefixtures("picture_env")
def test_video_is_recorded(tmp_path):
    pytest.importorskip("moviepy", reason="RecordVideo needs moviepy")
    env = gym.make("LQD/Faucet-v0", render_mode="rgb_array", width=64, height=48)
    env = RecordVideo(env, str(tmp_path / "videos"), disable_logger=True)
    env.reset()
    for _ in range(20):
        env.step(np.zeros(8))
    env.close()

    (video,) = (tmp_path / "videos").glob("*.mp4")
    assert video.stat().st_size > 500
