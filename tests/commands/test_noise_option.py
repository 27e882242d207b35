"""Are errors on the command line those of a level, or a level's times a scale?"""

import pytest

from agents._lib.noise_option import noise_option
from snooker_env.tasks import LEVELS, Noise


def test_a_level_is_its_name_and_a_scale_multiplies_its_errors():
    assert noise_option("club") == "club"
    twice, one = Noise.of(noise_option("professional*2")), LEVELS["professional"]
    assert (twice.aim_deg, twice.offset_mm, twice.elevation_deg, twice.speed_rel) == (
        0.028,
        0.17,
        0.22,
        0.034,
    )
    assert (twice.growth, twice.lapse, twice.lapse_factor) == (one.growth, one.lapse, one.lapse_factor)
    assert one.scale(1.0) == one
    assert Noise(speed_abs=0.1).scale(3.0).speed_abs == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize("wrong", ["loud", "club*", "club*x", "club*0", "club*nan"])
def test_anything_else_is_refused(wrong):
    with pytest.raises(ValueError, match="noise"):
        noise_option(wrong)
