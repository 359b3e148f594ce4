"""The others as a HAV under Reserve takes them, once they are gathered in slots of its memory."""

from baselines.policy import heard
from baselines.reserve.layout import (
    AFTER,
    CLOSE,
    COMPANIONS,
    COMPANY,
    FRAME,
    KIND,
    KNOWN,
    MODE,
    MOST_KNOWN,
    NUM_SLOTS,
    OUTLINE,
    RAW,
    RESERVED,
    SEEN,
    SLOT,
    SLOT_ROWS,
    STANDING,
    TURNED,
)
from hav_env.compiled import kernel, rare_kernel
from hav_env.geometry import into_frame
from hav_env.outline import (
    SIDES,
    outline_gap,
    turn_outline,
)
from hav_env.sensing import (
    neighbor_id,
    num_neighbors,
)


@kernel
def slot_at(number):
    """Return the first row of a slot."""
    return SLOT + SLOT_ROWS * number


@rare_kernel
def gap_to(rows, slot, outline, enough):
    """Return a lower bound of the distance [m] from an own outline to what is in a slot.

    Gaps are looked for across the own sides; then, if that may help to have enough [m], across the
    sides of the other one.
    """
    gap = outline_gap(rows, outline, slot + SEEN)
    if gap > enough or gap < enough - 4.0 or rows[slot + KIND] == STANDING:
        return gap
    x, y = rows[slot + FRAME], rows[slot + FRAME + 1]
    cosine, sine = rows[slot + FRAME + 2], rows[slot + FRAME + 3]
    back_x, back_y = -x * cosine - y * sine, x * sine - y * cosine
    turn_outline(rows, TURNED, rows, outline, back_x, back_y, cosine, -sine)
    return max(gap, outline_gap(rows, TURNED, slot + RAW))


@rare_kernel
def someone_within(rows, x, y, radius):
    """Tell whether the box round what is in a slot comes within a radius [m] of a place."""
    for number in range(int(rows[NUM_SLOTS])):
        seen = slot_at(number) + SEEN
        dx = max(x - rows[seen], -rows[seen + SIDES // 2] - x, 0.0)
        dy = max(y - rows[seen + SIDES // 4], -rows[seen + 3 * SIDES // 4] - y, 0.0)
        if dx * dx + dy * dy <= radius * radius:
            return True
    return False


@rare_kernel
def apart(rows, outline, kind, margin):
    """Tell whether an outline keeps a margin [m] from all slots of a kind; mark the close ones."""
    free = True
    for number in range(int(rows[NUM_SLOTS])):
        slot = slot_at(number)
        if rows[slot + KIND] != kind:
            continue
        near = gap_to(rows, slot, outline, margin) <= margin
        if kind == STANDING:
            rows[slot + CLOSE] = 1.0 if near else 0.0
        if near:
            free = False
            if kind == RESERVED:
                return False
    return free


@rare_kernel
def number_of_modes(policy, memory, world, agent, lane):
    """Return a number that changes, but for coincidence, with who of those in range stands."""
    total = 0.0
    for k in range(num_neighbors(world, agent, lane)):
        number = neighbor_id(world, agent, k, lane) + 1.0
        mode = heard(memory, world, agent, k, MODE, lane) if policy.broadcast else 0.0
        total += number * (number + 0.123) * mode
    return total


@rare_kernel
def note_company(policy, rows, memory, world, agent, lane):
    """Remember who is in sensing range, and who of them stands."""
    rows[KNOWN] = number_of_modes(policy, memory, world, agent, lane)
    count = min(num_neighbors(world, agent, lane), MOST_KNOWN)
    rows[COMPANY] = count
    for k in range(count):
        rows[COMPANIONS + k] = neighbor_id(world, agent, k, lane)


@rare_kernel
def is_known(rows, number):
    """Tell whether the HAV of this number was in sensing range when that was noted."""
    for k in range(int(rows[COMPANY])):
        if rows[COMPANIONS + k] == number:
            return True
    return False


@rare_kernel
def reserved_gap(rows, slot):
    """Return a lower bound of the distance [m] from what the HAV has reserved to a slot's.

    It is found as when the later one of both was reserved, so that it comes out the same.
    """
    x, y, cosine, sine = rows[AFTER], rows[AFTER + 1], rows[AFTER + 2], rows[AFTER + 3]
    if rows[slot + KIND] == STANDING:
        turn_outline(rows, TURNED, rows, OUTLINE, x, y, cosine, sine)
        return outline_gap(rows, TURNED, slot + SEEN)
    dx, dy = rows[slot + FRAME] - x, rows[slot + FRAME + 1] - y
    forward, left = into_frame(dx, dy, cosine, sine)
    c, s = into_frame(rows[slot + FRAME + 2], rows[slot + FRAME + 3], cosine, sine)
    turn_outline(rows, TURNED, rows, slot + RAW, forward, left, c, s)
    gap = outline_gap(rows, OUTLINE, TURNED)
    turn_outline(
        rows, TURNED, rows, OUTLINE, -forward * c - left * s, forward * s - left * c, c, -s
    )
    return max(gap, outline_gap(rows, TURNED, slot + RAW))


@kernel
def has_company_changed(policy, rows, memory, world, agent, lane):
    """Tell whether others are in sensing range, or stand, than when this was last looked at."""
    count = num_neighbors(world, agent, lane)
    if count != rows[COMPANY] or count > MOST_KNOWN:
        return True
    for k in range(count):
        if neighbor_id(world, agent, k, lane) != rows[COMPANIONS + k]:
            return True
    return rows[KNOWN] != number_of_modes(policy, memory, world, agent, lane)
