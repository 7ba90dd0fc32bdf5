"""Every number and claim of the paper that the scripts compare with, typed once from the paper (Noh, Choi,
Moon: Enhanced Direct Lighting Using Visibility-Aware Light Sampling, CGI 2023), each with its place. The text we have
carries no pictures: relL2 values printed inside Fig. 1 and Fig. 3 and the curves of Fig. 4 are unknown to us."""
from dataclasses import dataclass


# How our samplers are called in the paper (Sect. 5, first paragraph). The rest is not in the paper.
NAME_IN_PAPER = {"uniform+mesh": "Uniform", "spatial": "Spatial", "neepp": "NEE++", "octree:model=paper": "Ours"}

FIG1_SECONDS = 20  # caption of Fig. 1: "in twenty secs"


@dataclass(frozen=True)
class Breakdown:
    """A row of Table 1, seconds."""
    spp: int
    sampleGeneration: float
    octreeBuilding: float
    rendering: float
    total: float


TABLE1 = {
    "Lamp": Breakdown(4096, 0.12, 0.47, 229.1, 229.7),
    "Hotel": Breakdown(1024, 0.74, 1.78, 240.4, 242.9),
    "Whiteroom": Breakdown(1024, 0.63, 1.21, 202.3, 204.2),
}
OVERHEAD_SHARE = (0.00257, 0.01046)  # Sect. 5, "Our Computational Overhead": 0.257% to 1.046%


@dataclass(frozen=True)
class Granularity:
    """A row of Table 2. seconds: the overhead (sample generation and octree building)."""
    leaves: int
    relL2: float
    kilobytes: int
    seconds: float


TABLE2 = {
    "Lamp": {512: Granularity(778, 0.0102, 35, 0.50), 4096: Granularity(5349, 0.0077, 239, 0.59),
             32768: Granularity(43527, 0.0081, 1945, 0.77)},
    "Hotel": {512: Granularity(596, 0.0051, 43, 1.97), 4096: Granularity(4789, 0.0038, 345, 2.54),
              32768: Granularity(38914, 0.0037, 2801, 2.99)},
    "Whiteroom": {512: Granularity(505, 0.0073, 34, 1.47), 4096: Granularity(4537, 0.0052, 309, 1.90),
                  32768: Granularity(39250, 0.0089, 2672, 2.21)},
}

FIG5_SPP = 4096  # caption of Fig. 5: "with 4K spp"
FIG5 = {"uniform+mesh": 0.106, "spatial": 0.104, "octree:model=paper": 0.103}  # caption of Fig. 5, relL2


@dataclass(frozen=True)
class Claim:
    """The paper says that `lower` has less error than `higher`, `factor` times less where it gives a number."""
    lower: str
    higher: str
    place: str
    factor: float | None = None


OURS, UNIFORM, SPATIAL, NEEPP = "octree:model=paper", "uniform+mesh", "spatial", "neepp"
# Sect. 3, last paragraph: spatial and NEE++ do not effectively reduce the noise, Ours has much-reduced noise.
FIG1_CLAIMS = [Claim(OURS, other, "Sect. 3, about Fig. 1") for other in (UNIFORM, SPATIAL, NEEPP)]
# Sect. 5, "Comparisons of Light Sampling Methods".
LOWEST = [Claim(OURS, other, "Sect. 5, about Fig. 3") for other in (UNIFORM, SPATIAL, NEEPP)]
WORSE_THAN_UNIFORM = [Claim(UNIFORM, other, "Sect. 5, about Fig. 3") for other in (SPATIAL, NEEPP)]
FIG3_CLAIMS = {"Lamp": LOWEST + WORSE_THAN_UNIFORM, "Hotel": LOWEST, "Whiteroom": LOWEST + WORSE_THAN_UNIFORM}
LARGEST_GAIN = Claim(OURS, NEEPP, "Abstract and Sect. 5: up to 7 times", 7)
