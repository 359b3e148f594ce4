"""This module names the rows of the memory of a HAV under context steering."""

# time for which it has been blocked, and under way to this goal [steps]; number of goals left when
# that began; the side of its last free disc; its last steering [rad]; number of courses tried;
# whether the last course leads to the goal; whether it drove in the last step
(BLOCKED_STEPS, UNDER_WAY, GOALS, CIRCLED, LAST, TRIED, COMMITTED, DROVE, VALUES) = range(9)

# of each slot: its value; whether it is rated or masked; until when it is masked [steps]
MOST_SLOTS = 33
MARKS = VALUES + MOST_SLOTS
BANS = MARKS + MOST_SLOTS
TRIAL_SCRATCH = BANS + MOST_SLOTS
