"""Do tables of frames hand the referee and the frame what was played? Against ``Frame``, stroke by stroke."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from snooker_env.game.apply_ruling import settle_table
from snooker_env.game.attempt import ATTEMPT_GAP
from snooker_env.game.balls import BLACK, COLOURS_MASK, CUE, N_BALLS, SPOTS, balls_on, ids_of, mask_of_present
from snooker_env.game.frame_columns import SCORE_0, STRIKER
from snooker_env.game.in_hand import place_cue
from snooker_env.game.paths import paths
from snooker_env.game.referee import Stroke
from snooker_env.geometry import BALL_RADIUS
from snooker_env.simulation import simulate
from snooker_env.tasks.frame import Frames
from snooker_env.tasks.options import Options
from snooker_env.tasks.states import layout_of
from snooker_env.tasks.stroke import DOWN, FIRST, MOVED, SPEED, TOUCHING, VX, VY, WX, WY, WZ, ShotBuffers
from snooker_env.tasks.tables import Crew

N = 40


class Specification:
    """One frame, played in step with the kernels by ``Frame`` and the functions around it."""

    def __init__(self, tables, k):
        self.frame, self.k = tables.frame(k), k
        self.positions, self.on_table = tables.positions[k].copy(), tables.on_table[k].copy()
        self.table = tables.rules.table
        self.jaws = self.table.jaws[:, :3]
        self.miss, self.physics = tables.rules.misses, tables.rules.physics
        self.gaps = []
        self.time_to_play = tables.rules.time_to_play

    def times(self, duration):
        """The times of a stroke [ms]."""
        return {"time_to_play": self.time_to_play, "duration": int(1000 * duration + 0.5)}

    def decide(self, action):
        """What the action's last number says after a foul; is there a stroke?"""
        if self.frame.phase != "choice":
            return True
        last = self.frame.choices[-1]
        what = (
            "play_again"
            if action[-1] < -1 / 3
            else last
            if action[-1] > 1 / 3 and last in ("replace", "anywhere")
            else "play"
        )
        saved, self.frame = self.frame.saved, self.frame.choose(what)
        if what == "replace":
            self.positions, self.on_table = (np.array(part) for part in saved.layout)
        return what in ("play", "anywhere")

    def attempt(self, start, on, strike):
        """Whether the cue ball came near a ball of the mask ``on``: sampled from the shot, simulated anew."""
        v, w = np.zeros((N_BALLS, 2)), np.zeros((N_BALLS, 3))
        v[CUE], w[CUE] = strike[[VX, VY]], strike[[WX, WY, WZ]]
        shot = simulate(start, v, w, physics=self.physics, on_table=self.on_table)
        hits = shot.events["time"][(shot.events["kind"] == 0) & (shot.events["i"] == CUE)]
        until = hits[0] if len(hits) else shot.duration
        path = shot.at(np.linspace(0.0, until, 5_000))[0][:, CUE]
        places = start[list(ids_of(on))]
        gap = np.hypot(*(path[:, None] - places).T).min() - 2 * BALL_RADIUS
        self.gaps.append(gap)
        assert abs(gap - ATTEMPT_GAP) > 1e-3, "too near the limit for a sampled path: choose another seed"
        return bool(gap <= ATTEMPT_GAP)

    def judge(self, start, rest, seen, first_at_the_lot, events, duration, strike):
        """The stroke that left ``start`` (positions (22, 2)) and ended at ``rest``, as the referee saw it."""
        before, self.positions = self.frame, start
        mask = mask_of_present(self.on_table) & ~1
        on = balls_on(before.ball_on, mask) | (COLOURS_MASK & mask if before.free_ball else 0)
        table = self.table
        clear, cushions = (False, False), {"noses": table.noses, "jaws": table.jaws}
        if self.miss:
            clear = paths(self.positions, self.on_table, on, **cushions)
        if self.miss and before.in_hand and not clear[1]:  # wherever else it could have been put
            others = np.where(np.arange(N_BALLS) == CUE, False, self.on_table)
            elsewhere = paths(self.positions, others, on, anywhere=before.anywhere, **cushions)
            clear = clear[0] or elsewhere[0], elsewhere[1]
        layout = layout_of(self.positions, self.on_table) if self.miss else None
        first, touching, moved, potted = (int(seen[c]) for c in (FIRST, TOUCHING, MOVED, DOWN))
        cushion, late = bool(np.isin(events, (1, 2)).any()), 0 < before.shot_clock < self.time_to_play
        stroke = Stroke(
            first=first, touching=touching, moved=moved, potted=potted, no_cushion=not cushion, late=late
        )
        assert not late or (duration == 0.0 and not len(events))
        attempt = bool(before.miss != "attempt" or any(clear) or first & on) or self.attempt(
            start, on, strike
        )
        verdict, self.positions, self.on_table = settle_table(
            rest, self.on_table, before.situation, stroke, jaws=self.jaws
        )
        stroke = replace(
            stroke,
            snookered=verdict.free_ball,
            behind_free_ball=bool(verdict.fouls & verdict.fouls.BEHIND_FREE_BALL),
        )
        paths_and_times = {"clear_path": clear[0], "full_ball_path": clear[1], **self.times(duration)}
        self.frame, verdict = before.play(stroke, attempt=attempt, layout=layout, **paths_and_times)
        if self.frame.phase == "lot":
            self.on_table[1:], self.positions[BLACK] = np.arange(1, 22) == BLACK, SPOTS[BLACK]
            self.frame = self.frame.draw(first_at_the_lot)
        if self.frame.in_hand and self.frame.phase != "over":
            self.on_table[CUE] = False
            place = rest[CUE] if self.frame.anywhere and not potted & 1 else SPOTS[CUE]
            self.positions[CUE] = place_cue(
                self.positions, self.on_table, *place, anywhere=self.frame.anywhere
            )
            self.on_table[CUE] = True
        return verdict

    def check(self, tables):
        """Are the kernels' frame and table these, in every bit?"""
        k = self.k
        assert tables.frame(k) == self.frame
        assert np.array_equal(tables.positions[k], self.positions)
        assert np.array_equal(tables.on_table[k], self.on_table)


class Recording(Crew):
    """Notes where each shot started and ended."""

    def saw(self, which, buffers, own):
        """Play no more than there is room for: no shot of these needs a longer log."""
        assert not buffers.enlarged and own
        self.shots = {
            k: (
                buffers.r[j].copy(),
                buffers.seen[j].copy(),
                buffers.event_what[j, : buffers.n_events[j], 0].copy(),
                buffers.duration[j],
                buffers.shots[j].copy(),
            )
            for j, k in enumerate(which.tolist())
        }


SNOOKER = [
    ("snooker", miss, layout)
    for miss in ("off", "clear_path")
    for layout in ("break_off", "random:1", "snookered", "colours")
]
SNOOKER += [("snooker", "attempt", layout) for layout in ("random:1", "snookered")]
SIX_RED = [
    ("six_red", miss, layout)
    for miss, layout in [("off", "break_off"), ("clear_path", "break_off"), ("attempt", "random:3")]
]
SHOOT_OUT = [("shoot_out", "off", layout) for layout in ("break_off", "colours")]


@pytest.mark.parametrize(("game", "miss", "layout"), SNOOKER + SIX_RED + SHOOT_OUT)
def test_every_stroke_is_judged_as_by_the_specification(game, miss, layout):
    clock = {"time_to_play": 12.0} if game == "shoot_out" else {}  # too long in the second half
    # to every side, so that some escapes come near a ball on
    aim = "absolute" if miss == "attempt" else "target"
    options = Options(
        task="frame",
        layout=layout,
        miss=miss,
        aim=aim,
        decision=True,
        placement=True,
        max_strokes=None,
        game=game,
        **clock,
    )
    tables, rng, met = Frames(options.rules, N), np.random.default_rng(2), Counter()
    for k in range(N):
        tables.seed(k, rng)
    tables.deal(np.arange(N), drawn=True)
    # some scores, so that misses and needs of snookers differ
    tables.game[::3, SCORE_0] = rng.integers(0, 140, len(tables.game[::3]))
    written = [Specification(tables, k) for k in range(N)]
    crew = Recording(ShotBuffers(N, 2048))
    for _ in range(60):
        actions = rng.uniform(-1, 1, (N, 7))
        actions[:, 1 : 3 if miss == "attempt" else 4] *= 0.4
        starts = {}

        def prepare(which, buffers, actions=actions, starts=starts):
            which = which[~tables.ended()[which]]
            playing = tables.prepare(which, actions, buffers)
            starts.update({k: tables.positions[k].copy() for k in playing.tolist()})
            assert (buffers.shots[: len(playing), SPEED] > 0).all()
            return playing

        crew.shots = {}
        over = tables.ended().copy()
        out = tables.output()
        played = tables.turn(prepare, out, crew)
        for spec in written:
            k = spec.k
            if over[k]:
                continue
            assert spec.decide(actions[k]) == played[k]
            if played[k]:
                rest, seen, events, duration, strike = crew.shots[k]
                verdict = spec.judge(
                    starts[k], rest, seen, int(tables.game[k, STRIKER]), events, duration, strike
                )
                assert (out.reals[k, 0], out.counts[k, 0]) == (verdict.points, verdict.penalty)
                assert out.counts[k, 2] == int(verdict.fouls)
                met[verdict.visit_end.name] += 1
                met["free ball"] += spec.frame.free_ball
                met["miss"] += spec.frame.miss_called
                met["over"] += spec.frame.phase == "over"
                met["respotted"] += spec.frame.respotted_black
                met["anywhere"] += spec.frame.anywhere
                met["late"] += bool(verdict.fouls & verdict.fouls.LATE)
            met["replaced"] += not played[k] and spec.frame.saved is not None
            spec.check(tables)
    assert met["FOUL"] > 100 and met["MISS"] > 20 and (met["CONTINUES"] > 20 or miss == "attempt")
    assert (met["free ball"] > 0) == (game != "shoot_out")
    assert (met["anywhere"] > 20) == (met["late"] > 5) == (game == "shoot_out")
    assert (met["miss"] > 5 and met["replaced"] > 2) == (miss != "off")
    poor = [bool(gap > ATTEMPT_GAP) for spec in written for gap in spec.gaps]
    assert (miss == "attempt") == (sum(poor) > 0)
    # with few reds no attempt may have come near
    assert sum(poor) < len(poor) or miss != "attempt" or layout.startswith("random")
    assert (
        met["over"] > 0
        or miss == "attempt"
        or (layout in ("break_off", "snookered") and game == "snooker")
        or game == "six_red"
    )
    assert (met["over"] >= 0.9 * N) == (game == "shoot_out") or layout == "colours" or miss == "attempt"
