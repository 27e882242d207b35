"""What does a player say beside the stroke? Nominations, decisions after a foul, and declarations (concede, claim, let the
other begin): the one place where the numbers of an action become these codes."""

from .._lib.jit import kernel
from ..game import frame_columns as columns
from ..game.balls import COLOURS_MASK, YELLOW, balls_on_kernel
from ..game.fouls import AUTO

# Columns of the options that kernels take: what an action holds and says.
A_AIM = 0  # what the aim of a box action means: the index in ``box_actions.AIMS``
A_ELEVATION = 1  # the elevation that 1 means [rad]; 0: an action holds none
A_PLACEMENT = 2  # whether a box action holds the place of a cue ball in hand
A_DISCRETE = 3  # whether an action is a choice
A_NOMINATE = 4  # of a box action, the component that nominates; of choices 0; -1: none
A_DECISION = 5  # the component that decides after a foul, of a menu its first choice that does; -1: none
A_DECLARATION = 6  # the component that declares; -1: none
A_CONCEDE = 7  # whether an action can concede
A_CLAIM = 8  # whether it can claim the frame
A_LOT = 9  # whether it can let the other player begin after the lot
A_SPEEDS = 10  # of a menu, the cue speeds along each line; 0: the choices are those of ``discrete_actions``

SAYS = ("nominate", "decision", "concede", "claim", "lot")  # what an action can say beside the stroke
DECLARES = SAYS[2:]
(SAYS_NOTHING, CONCEDES, CLAIMS, OTHER_BEGINS) = range(4)  # declarations
OPTION_OF = ((CONCEDES, A_CONCEDE), (CLAIMS, A_CLAIM), (OTHER_BEGINS, A_LOT))  # the column that allows each
COLOURS = 6
STROKE_CHOICES = 540  # ``discrete_actions.SIZE``, the number of discrete actions that only choose a stroke


@kernel
def nominated_ball(n, row):
    """The ball that ``n`` (0 none, 1 to 6 yellow to black) nominates. After a red: that colour, else the next on the table. Of
    a free ball: that colour; 0, the ball on, if n is 0 or the colour is on anyway or absent. Otherwise AUTO."""
    if row[columns.BALL_ON] == 0:
        for c in range(COLOURS):
            ball = YELLOW + (max(n, 1) - 1 + c) % COLOURS
            if row[columns.ON_TABLE] >> ball & 1:
                return ball
        return AUTO
    if not row[columns.FREE_BALL]:
        return AUTO
    ball = YELLOW + n - 1
    mask = row[columns.ON_TABLE]
    free = COLOURS_MASK & mask & ~balls_on_kernel(row[columns.BALL_ON], mask)
    return ball if n > 0 and free >> ball & 1 else 0


@kernel
def nomination_of(a, options, row):
    """The ball that the action ``a`` nominates: a colour, 0 for a free ball declined, or AUTO."""
    if options[A_NOMINATE] < 0:
        return AUTO
    if options[A_DISCRETE]:
        c = int(a[0])
        return nominated_ball(c // STROKE_CHOICES if c < STROKE_CHOICES * (1 + COLOURS) else 0, row)
    x = 0.5 * (a[int(options[A_NOMINATE])] + 1.0)
    if row[columns.BALL_ON] == 0:
        return nominated_ball(1 + min(COLOURS - 1, int(COLOURS * x)), row)
    return nominated_ball(min(COLOURS, int((1 + COLOURS) * x)), row)


@kernel
def decision_of(a, options, row, rules):
    """What the striker decides after a foul with the action ``a``, if there is a choice, as a code. A number below -1/3:
    the offender plays again; above 1/3: from the position before, or the striker from anywhere, where that may be."""
    if options[A_DECISION] < 0 or row[columns.PHASE] != columns.CHOICE:
        return columns.PLAY
    if options[A_DISCRETE]:
        what = int(a[0]) - int(options[A_DECISION])  # below 0: a stroke
        x = 0.0 if what < 0 else 2.0 * what - 1.0
    else:
        x = a[int(options[A_DECISION])]
    if x < -1.0 / 3.0:
        return columns.PLAY_AGAIN
    return columns.allowed_choice(row, columns.REPLACE, rules) if x > 1.0 / 3.0 else columns.PLAY


@kernel
def playable(row, mask, nominated):
    """The balls in ``mask`` that may be struck first once ``nominated`` (0: none; or AUTO) has been said."""
    if nominated > 0:
        return (1 << nominated) & mask
    return balls_on_kernel(row[columns.BALL_ON], mask) if nominated == 0 else columns.strikeable(row, mask)


@kernel
def may_declare(what, row):
    """Whether the striker of a frame may say ``what`` now."""
    if row[columns.OVER]:
        return False
    if what == CONCEDES:
        return row[columns.PHASE] == columns.STROKE or row[columns.PHASE] == columns.CHOICE
    return columns.may_claim(row) if what == CLAIMS else row[columns.PHASE] == columns.LOT


@kernel
def declaration_of(a, options, row):
    """What the striker of a frame says with the action ``a``, if that is allowed now."""
    what = SAYS_NOTHING
    if options[A_DISCRETE]:
        extra = int(a[0]) - STROKE_CHOICES * (1 + COLOURS if options[A_NOMINATE] >= 0 else 1)
        if extra < 0:
            return SAYS_NOTHING
        for declared, column in OPTION_OF:
            if options[column]:
                if extra == 0:
                    what = declared
                extra -= 1
    elif options[A_DECLARATION] >= 0:
        x = a[int(options[A_DECLARATION])]
        if row[columns.PHASE] == columns.LOT:
            what = OTHER_BEGINS if options[A_LOT] and x < 0.0 else SAYS_NOTHING
        elif x < -2.0 / 3.0 and options[A_CONCEDE]:
            what = CONCEDES
        elif x > 2.0 / 3.0 and options[A_CLAIM]:
            what = CLAIMS
    return what if what != SAYS_NOTHING and may_declare(what, row) else SAYS_NOTHING
