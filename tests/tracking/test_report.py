import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from rerun.chunk import RrdReader

from pipeline.discrepancy.judgement.proof import BEYOND, HELDOUT
from pipeline.discrepancy.location.locate import locate
from pipeline.discrepancy.model.model import Hypothesis
from pipeline.discrepancy.model.result import (
    FOLLOWS,
    Calibration,
    Diagnosis,
    Errors,
    Estimate,
    Evidence,
    Location,
    NamedPhysics,
    NextExperiment,
    Unexplained,
    as_json,
)
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.catalogue import FORCES, MEANINGS
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.recording import Channel, Recording
from pipeline.tracking.report import write_report
from pipeline.tracking.report_words import (
    chance,
    error_sentence,
    number,
    percent,
    verdict_sentence,
)

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
QUIET = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--hide-scrollbars"]  # fmt: skip
BACKLASH = NamedPhysics(
    "backlash", "transmission", 0.9, (Estimate("width", 8.04, 7.9, 8.2, "deg"),), 2.94,
    ("friction",), "The drive turns through 8.04 deg of play before anything moves.",
)  # fmt: skip
COMMANDS = pd.DataFrame(
    {"time_s": [0.0, 3.0, 6.0, 9.0], "pitch_command_deg": [0.0, 30.0, -30.0, 0.0]}
)


def evidence(name: str = "pitch_angle_deg", cycles: int = 6) -> Evidence:
    phase = np.arange(cycles * 100) / 100
    drive = 60.0 * (4.0 * np.abs((phase + 0.75) % 1.0 - 0.5) - 1.0)
    cycle = np.arange(len(drive)) // 100
    time_s = 3.0 * np.arange(len(drive))
    rng = np.random.default_rng(0)
    after = 0.7 * play(drive, 4.0, 0.0)
    measured = after + 0.2 * rng.standard_normal(len(drive))
    measured[50:60] = np.nan
    samples = pd.DataFrame({"time_s": time_s, "cycle": cycle, "step": np.arange(len(drive)) % 100,
                            "pitch_command_deg": drive, name: measured})  # fmt: skip
    channels = (Channel("pitch_command_deg", "command", "deg"), Channel(name, "measurement", "deg"))
    motion = Motion(drive, time_s, cycle)
    heldout = cycle % 3 == 2
    found = Evidence(
        recording=Recording(samples, channels), measurement=name, drive="pitch_command_deg",
        static=True, motion=motion, measured=measured, train=~heldout, heldout=heldout,
        used=np.isfinite(measured), mistaken=np.zeros(len(measured), dtype=bool),
        before=0.7 * drive, after=after,
        deviation=np.full(len(drive), 0.2), noise=NoiseModel(0.2),
        hypotheses=(Hypothesis(("backlash",), 0.9, Mechanism()),
                    Hypothesis((), 0.1, Mechanism())),
    )  # fmt: skip
    located = locate(found.residual_before, motion, found.before, "deg", "deg")
    return replace(found, located=tuple(located))


def diagnosis(verdict: str = "ambiguous", name: str = "pitch_angle_deg") -> Diagnosis:
    structured = verdict in ("partly_explained", "unknown_physics")
    named = verdict not in ("no_mismatch", "unknown_physics")
    return Diagnosis(
        measurement=name, unit="deg", verdict=verdict, noise=0.2, before=Errors(2.9, 2.94),
        after=Errors(0.2, 0.22), location=(Location("direction", 0.9, 1e-12, "after"),),
        physics=(BACKLASH,) if named else (), calibration=Calibration(1.01, -0.2),
        unexplained=Unexplained(0.3, 1e-5, "the cycle") if structured
        else Unexplained(0.0, 1.0, None),
        not_excited=("coupling",),
        next_experiment=NextExperiment("would separate backlash from friction: small loops",
                                       "next_commands.csv") if verdict == "ambiguous" else None,
        notes=("10 of 600 samples were not measured.",),
    )  # fmt: skip


class Page(HTMLParser):
    """What a page holds: tags with their attributes, text, and every id."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data

    @property
    def words(self) -> str:
        return " ".join(self.text.split())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("run")
    unforced = replace(
        diagnosis("explained", "yaw_angle_deg"), not_excited=("coupling", *sorted(FORCES))
    )
    both = [diagnosis(), unforced]
    write_report(where, both, [evidence(), evidence("yaw_angle_deg")], [COMMANDS, None])
    return where


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page whose figures are blank: its words are looked at."""
    names = ("loop", "residual", "time", "where_direction", "next")
    blank = {name: Figure() for name in names}
    monkeypatch.setattr("pipeline.tracking.report.diagnosis_figures", lambda *_: blank)
    monkeypatch.setattr("pipeline.tracking.report.overview_figure", lambda _: Figure())


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    return Page((folder / "report.html").read_text(encoding="utf-8"))


def test_what_shows_only_in_a_force_stands_apart(page: Page) -> None:
    """It's no fault of a recording of angles that it has no inertia."""
    assert page.words.count("These show only where a force or torque is measured") == 1
    first, second = page.words.split("This recording could not have shown these")[1:]
    for kept in (first, second):
        assert kept.split("What to do next")[0].split("These show only")[0].endswith("coupling ")


def test_the_page_is_one_file_that_asks_for_nothing(folder: Path, page: Page) -> None:
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"https?:|//[a-z]|@import|\bfile:", text)
    assert not {"script", "link", "img", "iframe", "object"} & {tag for tag, _ in page.tags}
    for tag, attributes in page.tags:
        for name in ("src", "srcset", "action", "data"):
            assert name not in attributes, tag
        for name in ("href", "xlink:href"):
            assert (attributes.get(name) or "#").startswith("#"), attributes
    assert len(text) < 1_500_000


def test_every_reference_finds_its_one_target(page: Page) -> None:
    ids = [attributes["id"] for _, attributes in page.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    wanted = {
        (attributes.get("href") or attributes.get("xlink:href") or "#").removeprefix("#")
        for _, attributes in page.tags
    }
    assert wanted - {""} <= set(ids)


def test_pictures_and_tables_speak_to_who_does_not_see_them(page: Page) -> None:
    drawn = [attributes["aria-label"] for tag, attributes in page.tags if tag == "svg"]
    assert "pitch angle [deg] over pitch command [deg]" in drawn
    assert "measured − simulated [deg] over time [min]" in drawn
    assert all(re.fullmatch(r"\S.* over \S.*", words) for words in drawn)
    heads = [attributes for tag, attributes in page.tags if tag == "th"]
    assert heads
    assert all(attributes.get("scope") == "col" for attributes in heads)


def test_the_page_says_everything_that_a_mechanic_asks(page: Page) -> None:
    said = page.words
    for part in ("Before and after", "What is missing", "Where it shows", "How sure",
                 "What else it could be", "What to do next", "Small print"):  # fmt: skip
        assert said.count(part) == 2, part
    for part in (
        "The simulation leaves out backlash or friction; this recording can't tell which.",
        "falls from 2.94 to 0.22 deg; the noise is 0.2 deg",
        "The drive turns through 8.04 deg of play", "7.9 to 8.2", "90 % sure",
        "After each reversal, over", "would separate backlash from friction",
        "acquisition.commands=next_commands.csv", "gain 1.01, offset −0.2 deg", "coupling",
        "10 of 600 samples were not measured.", "without", MEANINGS["friction"],
    ):  # fmt: skip
        assert part.lower() in said.lower(), part


def test_pictures_stand_beside_for_print(folder: Path) -> None:
    for name in ("loop", "residual", "time", "where_direction", "next"):
        png = cv2.imread(str(folder / "figures" / f"pitch_angle_deg_{name}.png"))
        assert png is not None
        assert len(np.unique(png.reshape(-1, 3), axis=0)) > 20
        assert (folder / "figures" / f"pitch_angle_deg_{name}.pdf").read_bytes()[:4] == b"%PDF"


def test_the_same_stands_in_a_rerun_recording(folder: Path) -> None:
    reader = RrdReader(str(folder / "diagnosis.rrd"))
    entities = {str(chunk.entity_path) for chunk in reader.stream()}
    for name in ("pitch_angle_deg", "yaw_angle_deg"):
        for part in ("signals/measured", "signals/corrected", "signals/simulated_error",
                     "figures/loop", "figures/where_direction"):  # fmt: skip
            assert f"/{name}/{part}" in entities
    assert "/summary" in entities


@pytest.mark.usefixtures("undrawn")
def test_names_from_outside_are_no_markup(tmp_path: Path) -> None:
    odd = replace(diagnosis(), notes=("<script>alert(1)</script> & co",))
    write_report(tmp_path, [odd], [evidence()], [None if odd.notes == () else COMMANDS])
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<script>" not in text
    assert "&lt;script&gt;" in text


@pytest.mark.parametrize(
    ("notes", "once"),
    [((), "once gain and offset are right"), ((f"{FOLLOWS}: it snaps.",), "once that is followed")],
)
def test_what_has_no_name_but_is_followed_is_no_matter_of_gain(notes, once) -> None:
    unknown = replace(diagnosis("unknown_physics"), physics=(), notes=notes)
    assert once in error_sentence(unknown)


@pytest.mark.parametrize(
    ("verdict", "sentence"),
    [
        ("no_mismatch", "what differs is noise and calibration"),
        ("explained", "leaves out backlash (transmission)."),
        ("partly_explained", "and something more that nothing in the catalogue explains"),
        ("unknown_physics", "nothing in the catalogue explains it (it shows in the cycle)"),
        ("ambiguous", "backlash or friction; this recording can't tell which"),
    ],
)
def test_each_verdict_is_a_sentence(verdict: str, sentence: str) -> None:
    assert sentence in verdict_sentence(diagnosis(verdict))
    assert "0.22 deg" in (said := error_sentence(diagnosis(verdict)))
    told = verdict in ("explained", "partly_explained")
    assert ("Backlash may also be friction." in said) is told


TOO_MUCH = replace(BACKLASH, alternatives=(), surplus=True)
STOP = NamedPhysics("end_stop", "body", 0.9, (), 1.0, (), "It hits a stop.")


@pytest.mark.parametrize(
    ("verdict", "physics", "said"),
    [
        ("explained", (TOO_MUCH,), "The simulation has too much backlash (transmission)."),
        ("explained", (TOO_MUCH, STOP),
         "The simulation leaves out end stop (body) and has too much backlash (transmission)."),
        ("partly_explained", (TOO_MUCH,), "(transmission), and leaves out something more that"),
        ("ambiguous", (replace(BACKLASH, surplus=True), STOP),
         "leaves out end stop (body), and has too much backlash or leaves out friction; this"),
    ],
)  # fmt: skip
def test_too_much_of_something_is_not_said_to_be_left_out(verdict, physics, said) -> None:
    assert said in verdict_sentence(replace(diagnosis(verdict), physics=physics))
    written = as_json((replace(diagnosis(verdict), physics=physics),))
    assert all("surplus" not in p for p in written["measurements"][0]["physics"])


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    ("where", "said"),
    [
        ("everywhere", "(it shows everywhere)"),
        (HELDOUT, "(it shows on held-out samples, "),
        (BEYOND, "(it shows at held-out commands beyond "),
        ("after reversals", "(it shows after reversals)"),
        ("slow changes", "(it shows in slow changes)"),
    ],
)
def test_where_a_rest_shows_has_one_preposition(tmp_path: Path, where: str, said: str) -> None:
    unknown = diagnosis("unknown_physics")
    unknown = replace(unknown, unexplained=replace(unknown.unexplained, where=where))
    assert said in verdict_sentence(unknown)
    write_report(tmp_path, [unknown], [evidence()], [None])
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"bears no name: {said.strip('()')}" in page


@pytest.mark.parametrize("verdict", ["no_mismatch", "unknown_physics"])
def test_a_page_without_names_or_held_out_rows_is_whole(tmp_path: Path, verdict: str) -> None:
    nothing = replace(evidence(), located=(), hypotheses=())
    nothing = replace(nothing, heldout=np.zeros_like(nothing.heldout))
    unknown = Errors(float("nan"), float("nan"))
    write_report(tmp_path, [replace(diagnosis(verdict), after=unknown)], [nothing], [None])
    said = Page((tmp_path / "report.html").read_text(encoding="utf-8")).words
    assert "Along no single coordinate is there more than noise" in said
    assert "nan" not in said.lower().split()


def test_a_sure_name_comes_before_the_open_ones() -> None:
    sure = replace(BACKLASH, name="end_stop", site="body", alternatives=())
    open_one = replace(BACKLASH, alternatives=("friction", "frame_lag"))
    found = verdict_sentence(replace(diagnosis(), physics=(open_one, sure)))
    assert "end stop (body), and one of backlash, friction or frame lag;" in found


@pytest.mark.parametrize(
    ("value", "text"),
    [(8.0412, "8.04"), (0.0, "0"), (-0.2, "−0.2"), (1234.5, "1234"), (0.00012, "1.20e−04"),
     (float("nan"), "–"), (100.0, "100"), (0.21, "0.21"), (1700000003.2, "1700000003")],
)  # fmt: skip
def test_numbers_have_three_digits(value: float, text: str) -> None:
    assert number(value) == text


def test_shares_and_chances_in_words() -> None:
    assert [percent(s) for s in (0.0, 0.004, 0.71, 0.997, 1.0)] == [
        "0 %", "< 1 %", "71 %", "> 99 %", "100 %",
    ]  # fmt: skip
    assert "fewer than one recording in 1000" in chance(1e-6)
    assert "4 % of recordings" in chance(0.04)


def browse(tmp_path: Path, *arguments: str) -> str:
    assert CHROMIUM is not None
    profile = f"--user-data-dir={tmp_path / 'profile'}"
    shown = subprocess.run([CHROMIUM, *QUIET, profile, *arguments], capture_output=True,
                           timeout=60, check=False, text=True)  # fmt: skip
    assert shown.returncode == 0, shown.stderr
    return shown.stdout


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium; Debian's package is chromium")
@pytest.mark.parametrize("width", [360, 1280], ids=["telephone", "desk"])
def test_a_browser_needs_no_scrolling_sideways(folder: Path, tmp_path: Path, width: int) -> None:
    """A browser's window has a least width: the page stands in a frame of the wanted one."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    tell = "<script>parent.postMessage(document.documentElement.scrollWidth, '*')</script>"
    (tmp_path / "inner.html").write_text(text.replace("</body>", f"{tell}</body>"), "utf-8")
    outer = tmp_path / "outer.html"
    outer.write_text(
        "<body><script>onmessage = e => document.body.id = 'wide-' + e.data</script>"
        f'<iframe src="inner.html" width="{width}" height="2000" frameborder="0"></iframe></body>'
    )
    asked = browse(tmp_path, "--virtual-time-budget=4000", "--dump-dom", outer.as_uri())
    wide = re.search(r'<body id="wide-(\d+)"', asked)
    assert wide is not None
    assert int(wide.group(1)) <= width


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium; Debian's package is chromium")
def test_a_telephone_shows_every_column_of_a_table(tmp_path: Path) -> None:
    bend = Estimate("bend", 7.65e-5, -1.06e-5, 1.64e-4, "deg/deg^2")
    long = replace(diagnosis("explained"), physics=(replace(BACKLASH, parameters=(bend,)),))
    write_report(tmp_path, [long], [evidence()], [None])
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    tell = (
        "<script>parent.postMessage(Math.max(...[...document.querySelectorAll('table')]"
        ".map(t => t.scrollWidth - t.clientWidth)), '*')</script>"
    )
    (tmp_path / "inner.html").write_text(text.replace("</body>", f"{tell}</body>"), "utf-8")
    outer = tmp_path / "outer.html"
    outer.write_text(
        "<body><script>onmessage = e => document.body.id = 'hidden-' + e.data</script>"
        '<iframe src="inner.html" width="360" height="2000" frameborder="0"></iframe></body>'
    )
    asked = browse(tmp_path, "--virtual-time-budget=4000", "--dump-dom", outer.as_uri())
    assert 'id="hidden-0"' in asked


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium; Debian's package is chromium")
def test_a_browser_shows_the_pictures_in_the_colours_of_the_words(
    folder: Path, tmp_path: Path
) -> None:
    picture = tmp_path / "page.png"
    browse(tmp_path, "--window-size=1280,2600", f"--screenshot={picture}",
           (folder / "report.html").as_uri())  # fmt: skip
    pixels = cv2.imread(str(picture)).reshape(-1, 3).astype(int)
    for rgb in ((213, 94, 0), (0, 114, 178), (110, 110, 110)):
        assert (np.abs(pixels - rgb[::-1]).max(axis=1) < 12).sum() > 100, rgb


@pytest.mark.usefixtures("undrawn")
def test_one_explanation_alone_is_not_weighed(tmp_path: Path) -> None:
    """A lone row of 100 % would contradict how sure its name is said to be."""
    several = evidence()
    alone = replace(several, hypotheses=several.hypotheses[:1])
    for folder, found in ((tmp_path / "several", several), (tmp_path / "alone", alone)):
        write_report(folder, [diagnosis("explained")], [found], [None])
    texts = [(tmp_path / n / "report.html").read_text("utf-8") for n in ("several", "alone")]
    assert ["Explanations that were weighed" in text for text in texts] == [True, False]
    assert "90 %" in texts[0]
