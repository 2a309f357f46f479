"""The stages that make data: strokes, optima, policies and their measures, recorded episodes."""
import math
import os

from .stage import OUT, Stage

PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PYTHON = "/usr/bin/python3"
MODULE = "threelink_report.reproduction"

PENALTIES = {"vfs": 0, "eas_c1": 1, "eas_c2": 2, "eas": 3, "eas_c4": 4}  # strategy -> c
NAVIGATOR = "homing"  # plays the tasks: trained to reach points
STRATEGIES = (*PENALTIES, NAVIGATOR)  # that are measured
# The sweep of N_s: with the recipe, and with returns that end with the episode, as in the paper.
SWEEPS = {"steps": {}, "cut": {"advantage.bootstrap_at_time_limit": "false"}}
# The three basic strokes of Fig. 1b: bounds of both hinge angles [rad].
SQUARES = {"purcell": (-math.pi / 3, math.pi / 3), "clockwise": (-math.pi / 2, math.pi / 6),
           "counterclockwise": (-math.pi / 6, math.pi / 2)}
SQUARE_PIECES = 80
OPTIMA = {"speed": ("speed",), "efficiency": ("efficiency",),
          **{f"c{c}": ("energy_aware", "--c", str(c)) for c in (1, 2, 3, 4)}}
EPISODES = {"star": ("star.launch",), "pursuit_0": ("pursuit.launch", "v_ratio:=0"),
            "pursuit_05": ("pursuit.launch", "v_ratio:=0.5"),
            "pursuit_1": ("pursuit.launch", "v_ratio:=1")}
EPISODE_SEED = 1
TRAINING_SECONDS = 36  # of 40,000 episodes on one core


def sources(*names):
    """Python files of this package; what they made is out of date when they change."""
    return tuple(os.path.join(PACKAGE, name) for name in names)


# --- Physics --------------------------------------------------------------------------------------


def square_start(low):
    """swim's start: both hinges at `low`, the middle link along x, the centroid at 0."""
    return (-1 / 6 - math.cos(low) / 3, 2 * math.sin(low) / 9, -low, low, low)


def strokes():
    plan = []
    for name, (low, high) in SQUARES.items():
        rates, start = f"data/strokes/{name}_rates.csv", square_start(low)
        period = 4 * (high - low)
        plan += [
            Stage(f"rates_{name}", f"rates of the stroke {name}",
                  ("rosrun", "threelink_sim", "optimal_stroke", f"--square={low!r},{high!r}",
                   "--pieces", str(SQUARE_PIECES), "--out", OUT + "/square"),
                  {rates: "square.csv"}),
            Stage(f"stroke_{name}", f"stroke {name}",
                  ("rosrun", "threelink_sim", "swim", "--start=" + ",".join(map(repr, start)),
                   "--rates", rates, "--dt", repr(period / SQUARE_PIECES), "--out",
                   OUT + "/path.csv"),
                  {f"data/strokes/{name}.csv": "path.csv"}, (rates,))]
    return plan


def optima(scale):
    return [Stage(f"optimum_{name}", f"optimal stroke, {name}",
                  ("rosrun", "threelink_sim", "optimal_stroke", "--objective", *objective,
                   *scale.optimum, "--out", OUT + "/stroke"),
                  {f"data/optimum/{name}.json": "stroke.json",
                   f"data/optimum/{name}.csv": "stroke.csv"}, seconds=20)
            for name, objective in OPTIMA.items()]


# --- Policies -------------------------------------------------------------------------------------


def configuration(name, base, changes):
    words = [f"{key}={value}" for key, value in changes.items()]
    return Stage(f"config_{name}", f"configuration {name}",
                 (PYTHON, "-m", MODULE + ".configuration", base, OUT + "/config.yaml", *words),
                 {f"configs/{name}.yaml": "config.yaml"},
                 (base,) + sources("reproduction/configuration.py"))


def training(name, config, seed, episodes, share=1.0, policy=True):
    """training/NAME_SEED.csv and policies/NAME_SEED.safetensors; share: of the usual work."""
    run = f"{name}_{seed}"
    command = ("rosrun", "threelink_agent", "train", "--config", config, "--seed", str(seed),
               "--threads", "1", "--no-plot", "--resume", "--out", OUT + "/run")
    outputs = {f"training/{run}.csv": "run/metrics.csv"}
    if policy:
        outputs[f"policies/{run}.safetensors"] = "run/policy.safetensors"
    return Stage(f"train_{run}", f"training {name}, seed {seed}",
                 command + (("--episodes", str(episodes)) if episodes else ()), outputs, (config,),
                 seconds=TRAINING_SECONDS * share * (episodes or 40000) / 40000, resumable=True)


def policy_file(name, seed):
    return f"policies/{name}_{seed}.safetensors"


def seeds(scale):
    """Of the policies that are measured."""
    return range(scale.seeds if scale.mode == "full" else 1)


def policies(scale, config):
    if scale.mode == "quick":
        return [Stage(f"shipped_{name}", f"shipped policy {name}",
                      ("cp", f"{config}/policies/{name}.safetensors", OUT + "/policy"),
                      {policy_file(name, 0): "policy"},
                      (f"{config}/policies/{name}.safetensors",)) for name in STRATEGIES]
    plan = []
    for name in STRATEGIES:
        base = f"{config}/train_{name if name in ('vfs', NAVIGATOR) else 'eas'}.yaml"
        if name in PENALTIES:
            plan.append(configuration(name, base, {"environment.c": f"{PENALTIES[name]:.1f}"}))
            base = f"configs/{name}.yaml"
        share = 2.0 if name == NAVIGATOR else 1.0  # it takes twice the epochs
        plan += [training(name, base, seed, 0, share) for seed in seeds(scale)]
    return plan


def curves(scale, config):
    """The trainings of Fig. 3: in the full run, those of the policies."""
    if scale.mode == "full":
        return []
    return [training("curve_" + name, f"{config}/train_{name}.yaml", seed, scale.curve_episodes,
                     policy=False)
            for name in ("vfs", "eas") for seed in range(scale.seeds)]


def sweep(scale, config):
    plan = []
    for kind, changes in SWEEPS.items():
        for steps in scale.steps_sweep:
            name = f"{kind}_{steps}"
            plan.append(configuration(name, f"{config}/train_vfs.yaml",
                                      {"environment.steps": steps, **changes}))
            plan += [training(name, f"configs/{name}.yaml", seed, scale.sweep_episodes, steps / 200)
                     for seed in range(scale.sweep_seeds)]
    return plan


def measures(scale):
    names = [(name, seed) for name in STRATEGIES for seed in seeds(scale)]
    names += [(f"{kind}_{steps}", seed) for kind in SWEEPS for steps in scale.steps_sweep
              for seed in range(scale.sweep_seeds)]
    plan = []
    for name, seed in names:
        run, policy = f"{name}_{seed}", policy_file(name, seed)
        plan.append(Stage(
            f"evaluate_{run}", f"measures of {name}, seed {seed}",
            ("rosrun", "threelink_agent", "evaluate", "--policy", policy, "--json", "--trials",
             str(scale.trials), "--seed", "7", "--trajectory", OUT + "/way.csv"),
            {f"data/evaluate/{run}.json": "measures.json", f"data/way/{run}.csv": "way.csv"},
            (policy,), stdout="measures.json", seconds=scale.trials / 2000))
    return plan


# --- Tasks ----------------------------------------------------------------------------------------


def trials(scale):
    """Many episodes of each task, with every seed of the policy."""
    plan = []
    for name, (_, *arguments) in EPISODES.items():
        task = ("--task", name.partition("_")[0])
        ratio = [word.rpartition("=")[2] for word in arguments]
        for seed in seeds(scale):
            policy = policy_file(NAVIGATOR, seed)
            plan.append(Stage(
                f"trials_{name}_{seed}", f"trials of {name}, seed {seed}",
                ("rosrun", "threelink_tasks", "trials", *task, "--policy", policy, "--trials",
                 str(scale.stars if name == "star" else 100), "--seed", "1",
                 *(("--v-ratio", *ratio) if ratio else ()), "--json"),
                {f"data/trials/{name}_{seed}.json": "trials.json"}, (policy,), stdout="trials.json",
                seconds=10))
    return plan


def episodes():
    """One of each task over topics, in a bag that proves itself."""
    plan, policy = [], policy_file(NAVIGATOR, 0)
    for name, (launch, *arguments) in EPISODES.items():
        bag = f"bags/{name}.bag"
        plan += [
            Stage(f"play_{name}", f"episode {name}",
                  ("roslaunch", "threelink_tasks", launch, "rviz:=false", "realtime_factor:=0",
                   f"seed:={EPISODE_SEED}", "policy:=" + policy, *arguments, "bag_dir:=" + OUT),
                  {bag: "*_ep0001.bag"}, (policy,), seconds=12),
            Stage(f"proof_{name}", f"proof of the bag {name}",
                  ("rosrun", "threelink_tasks", "verify_bag", "--json", bag),
                  {f"data/proof/{name}.json": "proof.json"}, (bag,), stdout="proof.json",
                  seconds=3)]
    return plan
