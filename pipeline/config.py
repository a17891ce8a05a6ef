"""The schemas of all configuration; `conf/` holds the choices."""

from dataclasses import dataclass, field
from pathlib import Path

from hydra.core.config_store import ConfigStore
from omegaconf import MISSING, OmegaConf

from pipeline.config_importing import ImportingConfig

PACKAGE = Path(__file__).resolve().parent
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"

STAGES = (
    "acquisition",
    "vision",
    "selection",
    "training",
    "compensation",
    "evaluation",
    "diagnosis",
    "review",
)
EXTRA_STAGES = (
    "importing",
    "prediction",
    "baselines",
    "close_the_gap",
    "concealed",
    "fits",
    "crossed",
    "force_study",
)


@dataclass
class AcquisitionConfig:
    """The protocol of the paper: cycles of equal steps, a pause, an image."""

    axes: list[str] = field(default_factory=lambda: ["yaw", "pitch"])
    cycles: int = 9
    steps_per_cycle: int = 200
    pause_s: float = 3.0
    amplitude_deg: dict[str, float] = field(default_factory=lambda: {"yaw": 60.0, "pitch": 60.0})
    commands: str | None = None
    clock: str = "simulated"


@dataclass
class RobotConfig:
    """Which robot: `kind` is `emulated` or `epos2`; the latter needs a serial port.

    `nodes` names the controller of each axis, `encoder_pulses` a turn of its motor (four counts
    each) and `gear_ratio` the motor's turns for one of the shaft; limits are of the shaft.
    """

    kind: str = MISSING
    port: str | None = None
    baud: int = 115200
    nodes: dict[str, int] = field(default_factory=lambda: {"yaw": 1, "pitch": 2})
    encoder_pulses: int = 256
    gear_ratio: float = 64.0
    limit_deg: dict[str, float] = field(default_factory=lambda: {"yaw": 90.0, "pitch": 90.0})
    profile_velocity_rpm: int = 500
    profile_acceleration_rpm_s: int = 5000
    max_following_error_qc: int = 2000
    position_tolerance_qc: int = 10


@dataclass
class CameraConfig:
    """Which camera: `kind` is `twin` or one of `laboratory.CAMERAS`; not every key is of each."""

    kind: str = MISSING
    width_px: int = 1008
    height_px: int = 756
    jpeg_quality: int = 92
    devices: dict[str, int] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    stale_frames: int = 4


@dataclass
class AxisTwin:
    """A simulated axis: bend = gain shaft - cubic shaft^3, play [deg of shaft] and pose noise.

    `terms` are further physics: a name of the catalogue (or name/form) and its parameters by name.
    """

    gain: float = 0.80
    cubic: float = 1.0e-5
    play_half_width_deg: float = 0.0
    noise_deg: float = 0.0
    terms: dict[str, dict[str, float]] = field(default_factory=dict)


@dataclass
class TwinConfig:
    """The simulated robot."""

    yaw: AxisTwin = field(default_factory=AxisTwin)
    pitch: AxisTwin = field(default_factory=AxisTwin)


@dataclass
class VisionConfig:
    """HSV ranges (OpenCV: H 0-179) and the geometry that makes a pair of markers believable.

    `base_region` is where the base shaft runs from left to right, without the moving part: left,
    top, right and bottom as shares of the image.
    """

    green_hue: list[int] = field(default_factory=lambda: [40, 85])
    green_saturation: int = 70
    green_value: int = 40
    red_hue_low: list[int] = field(default_factory=lambda: [0, 10])
    red_hue_high: list[int] = field(default_factory=lambda: [170, 179])
    red_saturation: int = 90
    red_value: int = 50
    field_width_mm: float = 80.64
    marker_separation_mm: float = 15.2
    separation_tolerance: float = 0.08
    base_region: list[float] = field(default_factory=lambda: [0.02, 0.3, 0.36, 0.7])
    gate_deviations: float = 5.0
    workers: int = 2


@dataclass
class SplitConfig:
    """Which cycles train and test: `paper`, `leave_three_out`, `k_fold` or `explicit`."""

    kind: str = MISSING
    index: int = 0
    folds: int = 3
    train: list[int] = field(default_factory=list)
    test: list[int] = field(default_factory=list)


@dataclass
class SelectionConfig:
    """How K is chosen; a number in `k` fixes it.

    `scores` are worked out for each K, the criterion's always.
    """

    criterion: str = "bic"
    k: int | None = None
    k_max: int = 20
    n_init: int = 3
    scores: list[str] = field(default_factory=lambda: ["bic", "aic", "heldout"])


@dataclass
class TrainingConfig:
    """Expectation maximisation on standardised data."""

    n_init: int = 10
    reg_covar: float = 1e-5
    max_iterations: int = 500


@dataclass
class StepRuleConfig:
    """One step rule of the inverse search."""

    name: str = MISSING


@dataclass
class ArmijoConfig(StepRuleConfig):
    """The first step size, by how much it shrinks, and the share of the slope to be gained.

    See `pipeline.control.step_rules.armijo.Armijo`.
    """

    name: str = "armijo"
    initial: float = 1.0
    shrink: float = 0.5
    slope_share: float = 0.25


@dataclass
class ConstantConfig(StepRuleConfig):
    """The one step size, see `pipeline.control.step_rules.constant.Constant`."""

    name: str = "constant"
    step: float = 0.5


@dataclass
class DiminishingConfig(StepRuleConfig):
    """Step k is initial / k^power, see `pipeline.control.step_rules.diminishing.Diminishing`."""

    name: str = "diminishing"
    initial: float = 1.5
    power: float = 0.5


@dataclass
class BarzilaiBorweinConfig(StepRuleConfig):
    """The first step size; later ones follow from the search, `barzilai_borwein` says how."""

    name: str = "barzilai_borwein"
    initial: float = 0.5


@dataclass
class NewtonConfig(StepRuleConfig):
    """Nothing to set: the slope of the branch gives the step, see `step_rules.newton.Newton`."""

    name: str = "newton"


@dataclass
class CompensationConfig:
    """The inverse search: desired angles in, commands out."""

    algorithm: str = "corrected"
    step_rule: StepRuleConfig = field(default_factory=ArmijoConfig)
    tolerance_deg: float = 1e-6
    max_iterations: int = 200
    targets: int = 100
    target_amplitude_deg: float = 38.0


@dataclass
class EvaluationConfig:
    """How the tables are made; `trial` sends the compensated commands to the robot too."""

    tip_length_mm: float = 3.0
    trial: bool = True


@dataclass
class SimulatedAxis:
    """A mechanism as simulation: angle = gain command - cubic command^3, then physics by name."""

    command: str = MISSING
    gain: float = 1.0
    cubic: float = 0.0
    terms: dict[str, dict[str, float]] = field(default_factory=dict)


@dataclass
class SimulationConfig:
    """What simulates a measurement that has no simulation channel.

    `kind` is `recorded` (nothing else), `identity` (the measurement's own command), `affine` (gain
    and offset of a command, fitted to rows that are not held out), `trace` (`path`: a recording's
    folder or a table with `time_s` and the measurements' names), `mechanism` (`axes`, and `path`: a
    YAML of the same: measurement -> mechanism) or `python` (`function`, module:function, takes the
    table of commands and returns an array).
    """

    kind: str = "recorded"
    function: str | None = None
    path: str | None = None
    axes: dict[str, SimulatedAxis] = field(default_factory=dict)


@dataclass
class ToleranceConfig:
    """How far the simulation's gain, offset [unit] and curve [unit] are trusted.

    `accuracy` is the measurement's own: a mismatch whose root mean square stays below it once gain,
    offset and curve are right is none.
    """

    gain: float = 0.05
    offset: float = 2.0
    shape: float = 0.0
    accuracy: float = 0.0


@dataclass
class HeldoutConfig:
    """Which rows nothing is fitted to, and no name is chosen by; they may only refute one.

    `kind` is `every_third` cycle (the last third of the rows where there are fewer than three
    cycles), `last_third` of the rows, or `after_s`: all rows later than so many seconds after the
    first one.
    """

    kind: str = "every_third"
    after_s: float | None = None


@dataclass
class DiagnosisConfig:
    """How a mismatch is looked for.

    cutoff_hz: of the low-pass before a position is differentiated; found from its noise if null.
    """

    tolerance: ToleranceConfig = field(default_factory=ToleranceConfig)
    heldout: HeldoutConfig = field(default_factory=HeldoutConfig)
    cutoff_hz: float | None = None


@dataclass
class CloseTheGapConfig:
    """Record, diagnose, propose, record again: of which axis, and how often at most."""

    axis: str = "pitch"
    rounds: int = 3


@dataclass
class CrossedConfig:
    """What one job of the crossed study goes through on its split."""

    ks: list[int] = field(default_factory=lambda: list(range(1, 21)))
    step_rules: list[str] = field(
        default_factory=lambda: ["armijo", "barzilai_borwein", "constant", "diminishing", "newton"]
    )


@dataclass
class ConcealedConfig:
    """The concealed benchmark: its seed, and how many cases of each kind (half of them plain)."""

    seed: int = 0
    counts: dict[str, int] = field(default_factory=dict)


@dataclass
class CacheConfig:
    """Where results are kept for other runs; without `use` none are taken or kept."""

    use: bool = True
    folder: str = "outputs/.cache"


@dataclass
class ForceStudyConfig:
    """Two files below `importing.path`: one to diagnose, one to predict.

    mass: that the simulation has. published: parameters to compare with, as `term.parameter`.
    """

    fitted: str | None = None
    other: str | None = None
    mass: float = 0.0
    published: dict[str, float] = field(default_factory=dict)


@dataclass
class Config:
    """Everything that one run is told."""

    stages: list[str] = field(default_factory=lambda: list(STAGES))
    seed: int = 0
    recording: str | None = None
    earlier: str | None = None
    model: str | None = None
    importing: ImportingConfig = field(default_factory=ImportingConfig)
    acquisition: AcquisitionConfig = field(default_factory=AcquisitionConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    twin: TwinConfig = field(default_factory=TwinConfig)
    vision: VisionConfig = field(default_factory=VisionConfig)
    split: SplitConfig = field(default_factory=SplitConfig)
    selection: SelectionConfig = field(default_factory=SelectionConfig)
    training: TrainingConfig = field(default_factory=TrainingConfig)
    compensation: CompensationConfig = field(default_factory=CompensationConfig)
    evaluation: EvaluationConfig = field(default_factory=EvaluationConfig)
    simulation: SimulationConfig = field(default_factory=SimulationConfig)
    diagnosis: DiagnosisConfig = field(default_factory=DiagnosisConfig)
    close_the_gap: CloseTheGapConfig = field(default_factory=CloseTheGapConfig)
    crossed: CrossedConfig = field(default_factory=CrossedConfig)
    concealed: ConcealedConfig = field(default_factory=ConcealedConfig)
    force_study: ForceStudyConfig = field(default_factory=ForceStudyConfig)
    cache: CacheConfig = field(default_factory=CacheConfig)


STEP_RULES: dict[str, type[StepRuleConfig]] = {
    "armijo": ArmijoConfig,
    "constant": ConstantConfig,
    "diminishing": DiminishingConfig,
    "barzilai_borwein": BarzilaiBorweinConfig,
    "newton": NewtonConfig,
}


def register_schemas(store: ConfigStore) -> None:
    """Make the schemas known to Hydra, under the names that `conf/` refers to."""
    schema = OmegaConf.structured(Config)
    schema.compensation.step_rule = MISSING  # else only the default's own subclasses fit
    store.store(name="schema", node=schema)
    for name, rule in STEP_RULES.items():
        store.store(group="compensation/step_rule", name=f"schema_{name}", node=rule)
