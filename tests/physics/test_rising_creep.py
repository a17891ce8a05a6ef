"""Creep that grows with the pull, against what can be worked out by hand."""

import numpy as np

from pipeline.physics.creep import Creep
from pipeline.physics.motion import Motion
from pipeline.physics.rising_creep import RisingCreep, rising_as
from pipeline.physics.term import Surroundings

TIME_S = 2.0 * np.arange(200.0)


def held(drive: np.ndarray) -> Motion:
    return Motion(drive, TIME_S, np.zeros(len(drive), dtype=int))


def test_of_a_step_twice_as_far_four_times_as_much_arrives_late():
    near, far = (np.where(TIME_S > 0.0, step, 0.0) for step in (10.0, 20.0))
    values = np.array([0.0, 30.0, 0.0, 0.0, 0.004])
    late = [d - RisingCreep().respond(d, held(d), values, None)[0] for d in (near, far)]
    np.testing.assert_allclose(late[0][1:], 0.4 * np.exp(-TIME_S[1:] / 30.0), atol=1e-12)
    np.testing.assert_allclose(late[1], 4.0 * late[0], atol=1e-12)


def test_without_rise_it_is_creep_of_a_wire():
    drive = 30.0 * np.sin(TIME_S / 50.0)
    values = np.array([0.2, 15.0, 0.4, 3.0])
    rising = RisingCreep().respond(drive, held(drive), np.append(values, 0.0), None)[0]
    wire = Creep("wire").respond(drive, held(drive), values, None)[0]
    np.testing.assert_allclose(rising, wire, atol=1e-12)


def test_it_is_begun_with_about_the_loop_of_what_it_stands_for():
    around = Surroundings()
    speed = around.travel / (around.end_s - around.start_s)
    quarter = 0.5 * around.drive_span / speed
    time_s = np.arange(0.0, 12.0 * quarter, around.dwell_s)
    phase = time_s / quarter % 4.0
    shape = np.where(phase < 1, phase, np.where(phase < 3, 2 - phase, phase - 4))
    drive = 0.5 * around.drive_span * shape
    motion = Motion(drive, time_s, np.zeros(len(drive), dtype=int))
    last, half_way = time_s > 8.0 * quarter, np.abs(drive - 30.0) < 1.0
    for term, values in rising_as(1.0, around):
        late = drive - term.respond(drive, motion, values, None)[0]
        there = late[last & half_way]
        assert 0.3 < np.ptp(there) < 1.8
