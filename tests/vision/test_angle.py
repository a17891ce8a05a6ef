import cv2
import numpy as np
import pytest
from scene import CAMERA, GREEN_MM, RED_MM, decoy, glare, hide, hide_corner, through_jpeg, view

from pipeline.config import CameraConfig, VisionConfig
from pipeline.errors import LoopgapError
from pipeline.twin.microscope import BASE_TILT_DEG, GREEN_BGR, RED_BGR, arm_point_px, encode
from pipeline.vision.angle import decode, interpolated_median, measure_frame

CONFIG = VisionConfig()
POSES = (-38.3, -12.7, 0.0, 4.1, 31.9)


def error_deg(frame: np.ndarray, pose_deg: float) -> float:
    seen = measure_frame(frame, CONFIG)
    assert seen.reason == ""
    return abs(seen.angle_deg - pose_deg)


def test_default_images_over_the_whole_range_within_a_twentieth_of_a_degree():
    poses = np.linspace(-45.0, 45.0, 91)
    frames = [through_jpeg(view(p, seed=i), CAMERA.jpeg_quality) for i, p in enumerate(poses)]
    seen = [measure_frame(frame, CONFIG) for frame in frames]
    assert [s.reason for s in seen] == [""] * 91
    errors = np.array([s.angle_deg for s in seen]) - poses
    assert np.sqrt(np.mean(errors**2)) <= 0.05
    assert np.abs(errors).max() <= 0.15


def test_counter_clockwise_is_positive_and_up_in_the_image():
    seen = measure_frame(view(30.0), CONFIG)
    assert seen.angle_deg == pytest.approx(30.0, abs=0.15)
    assert seen.markers.red_px[1] < seen.markers.green_px[1]
    assert seen.base.direction_deg == pytest.approx(BASE_TILT_DEG, abs=0.02)
    assert seen.markers.direction_deg == pytest.approx(30.0 + BASE_TILT_DEG, abs=0.15)


@pytest.mark.parametrize("pose_deg", POSES)
def test_centres_are_where_the_markers_are(pose_deg):
    markers = measure_frame(view(pose_deg), CONFIG).markers
    for found, at_mm in ((markers.green_px, GREEN_MM), (markers.red_px, RED_MM)):
        assert found == pytest.approx(arm_point_px(at_mm, pose_deg, CAMERA.width_px), abs=0.4)


@pytest.mark.parametrize("turn_deg", [-8.0, 5.0])
def test_a_turned_camera_turns_both_lines_alike(turn_deg):
    frame = view(20.0)
    height, width = frame.shape[:2]
    turn = cv2.getRotationMatrix2D((width / 2, height / 2), turn_deg, 1.0)
    turned = cv2.warpAffine(frame, turn, (width, height), borderMode=cv2.BORDER_REPLICATE)
    seen = measure_frame(turned, CONFIG)
    assert seen.base.direction_deg == pytest.approx(BASE_TILT_DEG + turn_deg, abs=0.1)
    assert seen.angle_deg == pytest.approx(20.0, abs=0.15)


@pytest.mark.parametrize("bgr", [GREEN_BGR, RED_BGR])
@pytest.mark.parametrize("pose_deg", POSES)
def test_a_larger_block_of_a_markers_colour_is_not_taken_for_it(pose_deg, bgr):
    assert error_deg(decoy(view(pose_deg), (60.0, 12.0), bgr), pose_deg) <= 0.15


@pytest.mark.parametrize("pose_deg", POSES)
@pytest.mark.parametrize(("low_mm", "high_mm"), [(2.0, 3.1), (20.1, 21.2)])
def test_a_quarter_of_a_marker_hidden(pose_deg, low_mm, high_mm):
    assert error_deg(hide(view(pose_deg), pose_deg, low_mm, high_mm), pose_deg) <= 0.2


@pytest.mark.parametrize("pose_deg", POSES)
def test_defocus_strong_compression_and_glare(pose_deg):
    frame = view(pose_deg)
    assert error_deg(cv2.GaussianBlur(frame, (0, 0), 4.0), pose_deg) <= 0.2
    assert error_deg(through_jpeg(frame, 50), pose_deg) <= 0.2
    middle = arm_point_px(12.0, pose_deg, CAMERA.width_px)
    assert error_deg(glare(frame, middle, 60.0), pose_deg) <= 0.2


@pytest.mark.parametrize(
    ("low_mm", "high_mm", "reason"),
    [
        (1.9, 6.1, "no green marker"),
        (17.2, 21.3, "no red marker"),
        (18.2, 21.3, r"mostly hidden|no two markers"),
    ],
)
def test_a_missing_marker_gives_no_angle_but_the_reason(low_mm, high_mm, reason):
    seen = measure_frame(hide(view(15.0), 15.0, low_mm, high_mm), CONFIG)
    assert np.isnan(seen.angle_deg)
    assert seen.markers is None
    assert any(words in seen.reason for words in reason.split("|"))


@pytest.mark.parametrize("pose_deg", POSES)
def test_a_hidden_corner_would_turn_the_line_and_gives_no_angle(pose_deg):
    seen = measure_frame(hide_corner(view(pose_deg), pose_deg), CONFIG)
    assert np.isnan(seen.angle_deg)
    assert seen.reason.startswith("a corner of a marker is hidden")


def test_a_decoy_alone_is_no_marker():
    frame = decoy(hide(view(15.0), 15.0, 17.2, 21.3), (60.0, 12.0), RED_BGR)
    seen = measure_frame(frame, CONFIG)
    assert np.isnan(seen.angle_deg)
    assert seen.reason.startswith("no two markers 15.2 mm apart (nearest: ")


def test_two_pairs_that_fit_are_not_chosen_between():
    frame = view(25.0)
    shifted = np.roll(frame, 270, axis=1)
    both = np.where(np.arange(frame.shape[1])[None, :, None] < 660, frame, shifted)
    seen = measure_frame(both, CONFIG)
    assert seen.reason == "two pairs of markers fit equally well"
    assert np.isnan(seen.angle_deg)


def test_no_base_shaft_gives_no_angle_but_the_reason():
    frame = view(15.0)
    left = frame[:, :380]
    left[:] = np.random.default_rng(0).integers(150, 160, left.shape)
    seen = measure_frame(frame, CONFIG)
    assert np.isnan(seen.angle_deg)
    assert seen.markers is not None
    assert seen.reason.startswith("base shaft not found: ")


def test_something_lying_on_the_base_shaft_does_not_turn_the_base_line():
    frame = view(15.0)
    frame[330:360, 120:200] = (90, 80, 70)
    assert error_deg(frame, 15.0) <= 0.15


def test_an_image_too_small_to_see_anything():
    seen = measure_frame(np.zeros((3, 4, 3), np.uint8), CONFIG)
    assert seen.reason == "no green marker; base shaft not found: base_region is 1 x 1 px"


def test_full_size_images():
    camera = CameraConfig(kind="twin", width_px=4032, height_px=3024)
    assert error_deg(view(-27.0, camera), -27.0) <= 0.05


def test_an_unreadable_image_names_its_file():
    with pytest.raises(LoopgapError, match=r"frames/yaw_000007.jpg: expected an image; found 5"):
        decode(b"hello", "frames/yaw_000007.jpg")
    with pytest.raises(LoopgapError, match="found 0 bytes"):
        decode(b"", "x.jpg")
    assert decode(encode(view(0.0), 92), "x.jpg").shape == (756, 1008, 3)


def test_interpolated_median_is_that_of_grouped_data():
    # 1, 2, 2, 3, 3, 3: the 3rd of 6 ends class 2, which reaches to 2.5
    assert interpolated_median(np.array([1.0, 2, 2, 3, 3, 3]), 1.0) == pytest.approx(2.5, abs=1e-3)
    # half of 5 is 2.5: one below, then 1.5 of the 3 in class 2, from 1.5 on
    assert interpolated_median(np.array([1.0, 2, 2, 2, 3]), 1.0) == pytest.approx(2.0, abs=1e-3)
    assert interpolated_median(np.array([1.0, 1, 2, 2, 2]), 1.0) == pytest.approx(5 / 3, abs=1e-3)
