import cv2
import numpy as np
import pytest

from pipeline.config import CameraConfig, VisionConfig
from pipeline.twin import microscope
from pipeline.twin.microscope import (
    FIELD_WIDTH_MM,
    GREEN_MM,
    NOISE_GREY,
    RED_MM,
    TwinCamera,
    arm_point_px,
    render,
)

CAMERA = CameraConfig(kind="twin")
FULL = CameraConfig(kind="twin", width_px=4032, height_px=3024)


def view(pose_deg: float, camera: CameraConfig = CAMERA, seed: int = 0) -> np.ndarray:
    return render(pose_deg, camera, np.random.default_rng(seed))


def colour_centre_px(frame: np.ndarray, channel: int) -> np.ndarray:
    """Centroid (x, y) of how much one channel exceeds both others."""
    first, second = (frame[..., c] for c in {0, 1, 2} - {channel})
    excess = cv2.subtract(frame[..., channel], cv2.max(first, second))
    moments = cv2.moments(cv2.subtract(excess, np.full_like(excess, 20)))
    return np.array([moments["m10"], moments["m01"]]) / moments["m00"]


@pytest.fixture
def flat_light(monkeypatch):
    """Paint only: no shading, gloss, shadow or noise."""
    for name, value in {"AMBIENT": 1.0, "GLOSS": 0.0, "SHADOW": 0.0, "NOISE_GREY": 0.0}.items():
        monkeypatch.setattr(microscope, name, value)
    monkeypatch.setattr(microscope, "_light", lambda w, h: np.ones((h, w), np.float32))
    microscope.backdrop_of.cache_clear()
    yield
    microscope.backdrop_of.cache_clear()


@pytest.mark.usefixtures("flat_light")
@pytest.mark.parametrize("pose_deg", [-45.0, -20.3, 0.0, 0.05, 33.0, 45.0])
def test_the_arm_is_where_its_pose_says(pose_deg):
    frame = view(pose_deg)
    green, red = colour_centre_px(frame, 1), colour_centre_px(frame, 2)
    true_green, true_red = (
        arm_point_px(np.mean(at_mm), pose_deg, 1008) for at_mm in (GREEN_MM, RED_MM)
    )
    assert green == pytest.approx(true_green, abs=0.03)
    assert red == pytest.approx(true_red, abs=0.03)


def test_a_hundredth_of_a_degree_moves_the_picture_evenly():
    poses = 10.0 + 0.01 * np.arange(20)
    heights = [colour_centre_px(view(p), 2)[1] for p in poses]
    step_px = np.deg2rad(0.01) * np.mean(RED_MM) * 1008 / FIELD_WIDTH_MM * np.cos(np.deg2rad(11.3))
    slope = np.polyfit(np.arange(20), heights, 1)[0]
    assert slope == pytest.approx(-step_px, rel=0.15)


def test_every_size_shows_the_same_scene():
    small, full = view(25.0), view(25.0, FULL)
    assert full.shape == (3024, 4032, 3)
    shrunk = cv2.resize(full, (1008, 756), interpolation=cv2.INTER_AREA)
    assert np.abs(shrunk.astype(float) - small).mean() < 3.0
    full_px = (colour_centre_px(full, 2) + 0.5) / 4 - 0.5
    assert full_px == pytest.approx(colour_centre_px(small, 2), abs=0.1)


def test_sensor_noise_is_new_in_every_frame_and_of_its_size():
    first, second = view(0.0, seed=1), view(0.0, seed=2)
    difference = first[600:, 600:].astype(float) - second[600:, 600:]
    assert difference.std() == pytest.approx(np.sqrt(2) * NOISE_GREY, rel=0.1)
    np.testing.assert_array_equal(first, view(0.0, seed=1))


def test_the_light_is_uneven():
    frame = view(0.0).astype(float)
    assert frame[:100, 300:400].mean() - frame[-100:, -100:].mean() > 15.0


def test_vision_knows_the_markers_of_the_twin():
    assert VisionConfig().marker_separation_mm == pytest.approx(np.mean(RED_MM) - np.mean(GREEN_MM))
    assert VisionConfig().field_width_mm == FIELD_WIDTH_MM


def test_the_camera_sees_the_pose_of_the_moment():
    pose = {"deg": 0.0}
    camera = TwinCamera("yaw", lambda: pose["deg"], CAMERA, seed=5)
    centres = []
    for pose["deg"] in (10.0, -10.0):
        frame = cv2.imdecode(np.frombuffer(camera.grab(), np.uint8), cv2.IMREAD_COLOR)
        centres.append(colour_centre_px(frame, 2)[1])
    camera.close()
    assert camera.name == "yaw"
    assert centres[0] < centres[1] - 70
