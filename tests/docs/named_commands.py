"""Which commands does the documentation name, and how does a test run each?"""

SHORT = {
    "benchmarks.tradeoff": "--impacts 30 --shots 12 --repeats 1 --out {tmp}",
    "benchmarks.scene": "--shots 12 --repeats 1 --models 'spin decay' 'jaw arcs' --out {tmp}",
    "benchmarks.pockets": "--quick --out {tmp}",
    "benchmarks.rack": "--shots 2 --orders 2 --racks 2 --out {tmp}",
    "benchmarks.stability": "--fuzz 2000 --out {tmp}",
    "benchmarks.speed": "--shots 20 --repeats 1 --parts impacts shots growth --largest-batch 64 --out {tmp}",
    "benchmarks.fit_cushion": "",
    "benchmarks.nap": "",
    "benchmarks.make_opened": "--tables 2 --out {tmp}",
    "benchmarks.execution": "--strokes 40 --visits 4 --levels professional robot",
    "benchmarks.fair": "--tables 2 --kinds snookered",
    "benchmarks.frames": "--frames 2 --jobs 1",
    "benchmarks.layouts_picture": "--out {tmp}",
    "benchmarks.pictures": "--out {tmp}",
    "benchmarks.diagrams": "--out {tmp}",
    "benchmarks.planning": "--strokes 100 --repeats 2",
    "benchmarks.value_inputs": "--positions 1000 --steps 20",
    "benchmarks.decisions": "--agents ghost_ball planner_30 --tables 1 4 --repeats 2",
    "benchmarks.learner": "--rounds 1 --steps 2",
    "benchmarks.temperature": "--visits 2 --temperatures 4 8",
    "benchmarks.fuzz": "--shots 300 --threads 1",
    "benchmarks.vector": "--seconds 0.1 --repeats 1 --tables 64 --ppo-steps 2048",
    "agents.value_quality": "--agent planner_30 --visits 3",
    "agents.watch": "--agent ghost_ball --out {tmp}/visit.html",
    "tests.rules_cases": "tests/data/rules_cases.json",
    "tests.oracles.frame_oracle": "--frames 2 --kind tables",
    "docs/pictures/make.py": "--out {tmp}",
    "docs/films/make.py": "--only pot_easy --out {tmp}",
}
"""Module or file -> arguments of a run of a few seconds; "{tmp}" is a folder that is thrown away."""

ELSEWHERE = {
    "pytest": ".ci/run",
    "sphinx": ".ci/run",
    "venv": ".ci/run",
    "train.py": "tests/agents/test_train.py",
    "tests.golden": "tests/test_golden.py",
    "snooker_env.play": "tests/play/test_server.py",
    "snooker_env.advice": "tests/advice/test_command.py",
    "snooker_env.benchmark": "tests/benchmark/test_results.py",
    "benchmarks.paper": "tests/benchmarks/test_benchmark_commands.py",
    "benchmarks.left_out": "tests/benchmarks/test_benchmark_commands.py",
    "agents.evaluate": "tests/commands/test_lifecycle.py",
    "agents.report": "tests/commands/test_lifecycle.py",
    "agents.curves": "tests/agents/evaluation/test_learning_curves.py",
    "agents.publish": "tests/agents/evaluation/test_publish.py",
    "agents.tournament": "tests/agents/evaluation/test_tournament.py",
    "agents.search": "tests/cluster/test_searched.py",
    "benchmarks.cluster": "tests/cluster/test_ray_commands.py",
    "examples/fit_your_data.py": "tests/examples/test_fit.py",
    "examples.self_play": "tests/examples/test_self_play.py",
    "examples.ppo_single_file": "tests/examples/test_ppo_single_file.py",
    "examples.ppo_torchrl": "tests/examples/test_ppo_torchrl.py",
    "agents.train_rllib": "tests/agents/trainers/test_rllib_run.py",
    "rl_zoo3.train": "tests/agents/trainers/test_rl_zoo.py",
}
"""Module or file -> the test that runs it."""

NOT_RUN = {
    "coverage": "it would run this suite within the suite; it is of the extra dev, which tests do not need"
}
