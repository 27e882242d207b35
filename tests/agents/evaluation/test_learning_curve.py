"""Does the learning curve show what was learned, beside the other players?"""

from agents.evaluation.learning_curve import LearningCurve
from tests.pictures import saved_figures, unreadable

MEANS = {"trained": 22.8, "ghost_ball": 5.9, "random": 1.2, "planner": 46.8}
FIGURES = {
    name: {"adjusted_a_visit": mean, "adjusted_a_visit_se": 0.5, "visits": 500}
    for name, mean in MEANS.items()
}
POINTS = [{"steps": 8192 * (k + 1), "points": 20.0 * k / (k + 3)} for k in range(20)]
CURVE = LearningCurve("strokes", POINTS, FIGURES)


def test_on_a_terminal_it_rises_from_random_to_the_level_of_the_trained_agent():
    head, *rows, foot = CURVE.text()
    assert "points a visit" in head and foot.endswith("163,840 shots")
    scale = [float(row.partition("|")[0]) for row in rows]
    assert scale[0] == 46.8 and scale[-1] == 0.0
    step = scale[0] - scale[1]
    for name, mean in MEANS.items():
        label = f"{'strokes' if name == 'trained' else name} {mean}"
        (at,) = (level for level, row in zip(scale, rows, strict=True) if label in row)
        assert abs(at - mean) <= 0.51 * step + 0.05
    stars = {column: k for k, row in enumerate(rows) for column, sign in enumerate(row) if sign == "*"}
    heights = [stars[column] for column in sorted(stars)]
    assert len(heights) == len(POINTS) and heights == sorted(heights, reverse=True)
    assert max(map(len, (head, *rows, foot))) <= 100


def test_its_picture_can_be_read(tmp_path):
    with saved_figures() as figures:
        CURVE.draw(tmp_path / "curve.png", 212.0)
    (figure,) = figures
    assert unreadable(figure) == []
