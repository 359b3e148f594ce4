"""A browser plays the page that replays an episode: everything on it works, without an error."""

import time

import numpy as np
import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.select import Select

from baselines.replay.trajectory import body_corners, front_points
from baselines.replay.web_page import template
from tests.browser.page_driver import (
    click_at,
    colors_near,
    colors_of,
    drawn_time,
    named,
    place_of,
    press,
    seek,
    state,
    wait_for,
)
from tests.support.recorded import HIT, WALLS


def test_it_plays_and_pauses(page):
    driver = page("pair")
    assert state(driver, "time") == 0
    assert not state(driver, "playing")
    named(driver, "play").click()
    assert state(driver, "playing")
    wait_for(lambda: state(driver, "time") > 3)
    assert named(driver, "play").get_attribute("aria-label") == "Pause"
    named(driver, "play").click()
    stopped = state(driver, "time")
    wait_for(lambda: drawn_time(driver) == f"{stopped:.1f} s")
    time.sleep(0.1)
    assert state(driver, "time") == stopped
    assert not state(driver, "playing")


def test_it_stops_at_the_end_and_begins_again(page, trajectories):
    driver = page("pair")
    duration = trajectories["pair"].step[-1] * 0.2
    assert state(driver, "duration") == pytest.approx(duration)
    seek(driver, duration - 1)
    press(driver, Keys.SPACE)
    wait_for(lambda: state(driver, "time") == pytest.approx(duration))
    wait_for(lambda: not state(driver, "playing"))
    press(driver, Keys.SPACE)
    assert state(driver, "time") < duration - 5
    press(driver, Keys.SPACE)


def test_the_speed_is_that_of_the_clock(page):
    driver = page("pair")
    rates = {}
    for speed in ("2", "20"):
        Select(named(driver, "speed")).select_by_value(speed)
        assert state(driver, "speed") == float(speed)
        seek(driver, 0)
        rate = driver.execute_async_script(
            "const done = arguments[0]; document.getElementById('play').click();"
            "setTimeout(() => { const [t, r] = [performance.now(), window.replay.time];"
            "setTimeout(() => { const rate = 1000 * (window.replay.time - r)"
            " / (performance.now() - t); document.getElementById('play').click(); done(rate); },"
            " 1000); }, 200)"
        )
        rates[speed] = rate / float(speed)
    # a busy machine skips frames, but none goes faster than the clock
    assert all(0.3 < rate < 1.15 for rate in rates.values()), rates


def test_the_slider_scrubs(page):
    driver = page("pair")
    named(driver, "scrub").click()  # in its middle
    assert state(driver, "time") == pytest.approx(state(driver, "duration") / 2, rel=0.03)
    before = state(driver, "time")
    press(driver, Keys.ARROW_RIGHT)
    assert state(driver, "time") == pytest.approx(before + 1)
    press(driver, Keys.HOME)
    assert state(driver, "time") == 0


def test_vehicles_are_where_the_episode_has_them(page, trajectories):
    driver, trajectory = page("pair"), trajectories["pair"]
    moments = (0, 150, 400)
    found, true = [], []
    for step in moments:
        seek(driver, step * 0.2)
        found += [place_of(driver, hav) for hav in (0, 1)]
        true += [(trajectory.x[step, hav], trajectory.y[step, hav]) for hav in (0, 1)]
    shown, metres = np.array(found), np.array(true) * (1, -1)  # on the screen y points down
    scale = np.linalg.norm(shown[1] - shown[0]) / np.linalg.norm(metres[1] - metres[0])
    offset = shown - scale * metres
    assert np.abs(offset - offset[0]).max() < 0.05  # pixels
    # between two states it moves on evenly
    seek(driver, 30.1)
    between = trajectory.x[150:152].mean(axis=0), -trajectory.y[150:152].mean(axis=0)
    for hav in (0, 1):
        place = scale * np.array([axis[hav] for axis in between]) + offset[0]
        assert np.abs(place_of(driver, hav) - place).max() < 0.1


def test_bodies_are_drawn_where_they_collide(page, trajectories):
    driver, trajectory = page("real"), trajectories["real"]
    origin = [np.round((axis.min() + axis.max()) / 2) for axis in (trajectory.x, trajectory.y)]
    for row in (0, len(trajectory.step) // 2, -1):
        seek(driver, trajectory.step[row] * 0.2)
        for hav in range(4):
            script = f"return window.replay.cornersOf({hav})"
            shown = np.array(driver.execute_script(script)) + origin
            np.testing.assert_allclose(shown, body_corners(trajectory, hav, row), atol=0.02)


def test_hitches_are_drawn_behind_and_ahead_of_axles(page, trajectories):
    driver, trajectory = page("hitched"), trajectories["hitched"]
    origin = [np.round((axis.min() + axis.max()) / 2) for axis in (trajectory.x, trajectory.y)]
    seek(driver, trajectory.step[-1] * 0.2)
    assert driver.execute_script("return window.replay.cornersOf(0)") is None  # bodies are lines
    for hav in range(4):
        shown = np.array(driver.execute_script(f"return window.replay.frontsOf({hav})")) + origin
        np.testing.assert_allclose(shown, front_points(trajectory, hav, -1), atol=0.02)


@pytest.mark.parametrize(
    ("name", "count"), [("single", 1), ("pair", 2), ("swarm", 50), ("real", 4), ("hitched", 4)]
)
def test_all_vehicles_are_drawn(name, count, page):
    driver = page(name)
    assert state(driver, "numHavs") == state(driver, "vehiclesDrawn") == count
    assert len(driver.find_elements(By.CSS_SELECTOR, "#havs li")) == count
    seek(driver, state(driver, "duration"))
    assert state(driver, "vehiclesDrawn") == count
    assert len(colors_of(driver, "plane")) > 20


def test_who_has_left_is_not_drawn(page):
    driver = page("left")
    assert state(driver, "vehiclesDrawn") == 2
    seek(driver, 36.0)
    wait_for(lambda: state(driver, "vehiclesDrawn") == 1)


def test_a_click_selects_and_shows_the_articulations(page):
    driver = page("pair")
    assert not named(driver, "details").is_displayed()
    seek(driver, 70)
    click_at(driver, place_of(driver, 1))
    assert state(driver, "selected") == 1
    assert named(driver, "chart").is_displayed()
    wait_for(lambda: len(colors_of(driver, "chart")) > 10)
    figures = named(driver, "figures").text
    assert "HAV 0" in figures  # which it evades
    assert "0 of 2" in figures
    click_at(driver, place_of(driver, 0))
    assert state(driver, "selected") == 0
    click_at(driver, (30, 400))  # a place without a HAV
    assert state(driver, "selected") is None
    assert not named(driver, "details").is_displayed()


def test_the_keyboard_alone_is_enough(page):
    driver = page("pair")
    press(driver, "]", "]")
    assert state(driver, "selected") == 1
    press(driver, "[")
    assert state(driver, "selected") == 0
    press(driver, Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_LEFT)
    wait_for(lambda: drawn_time(driver) == "1.0 s")
    near = place_of(driver, 1) - place_of(driver, 0)
    press(driver, "+")
    wait_for(lambda: np.allclose(place_of(driver, 1) - place_of(driver, 0), 1.4 * near))
    press(driver, "f", Keys.ESCAPE)
    wait_for(lambda: np.allclose(place_of(driver, 1) - place_of(driver, 0), near))
    assert state(driver, "selected") is None


def test_wheel_and_drag_move_the_view(page):
    driver = page("swarm")
    plane = named(driver, "plane")
    place = place_of(driver, 3)
    ActionChains(driver).drag_and_drop_by_offset(plane, 60, -40).perform()
    wait_for(lambda: np.allclose(place_of(driver, 3) - place, (60, -40), atol=0.5))
    assert state(driver, "selected") is None  # a drag is no click
    driver.execute_script(
        "arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -4000, cancelable: true}))",
        plane,
    )
    wait_for(lambda: state(driver, "vehiclesDrawn") < 50)
    named(driver, "fit").click()
    wait_for(lambda: state(driver, "vehiclesDrawn") == 50)
    assert np.allclose(place_of(driver, 3), place)


def test_an_event_takes_there(page, trajectories):
    driver = page("single")
    step, joint = trajectories["single"].first[0, 0]
    assert step == 381
    assert state(driver, "events") == [
        {"time": pytest.approx(step * 0.2), "text": f"HAV 0 jackknifes at joint {joint}"},
        {"time": pytest.approx(400 * 0.2), "text": "time was up"},
    ]
    driver.find_element(By.CSS_SELECTOR, "#events li button").click()
    wait_for(lambda: drawn_time(driver) == f"{step * 0.2:.1f} s")
    assert state(driver, "selected") == 0
    assert f"joint {joint}" in named(driver, "figures").text
    assert "jackknifed" in driver.find_element(By.CSS_SELECTOR, "#havs li").text


def test_obstacles_are_drawn_and_become_red_when_they_are_hit(page, trajectories):
    driver, walls = page("walls"), trajectories["walls"]
    when = HIT * walls.dt
    assert state(driver, "events") == [
        {"time": pytest.approx(when), "text": "HAV 0: obstacle collision"},
        {"time": pytest.approx(walls.step[-1] * walls.dt), "text": "time was up"},
    ]
    own, other = place_of(driver, 0), place_of(driver, 1)
    scale = (own[1] - other[1]) / (walls.y[0, 1] - walls.y[0, 0])  # pixels per metre
    away = WALLS[0, :2] + [0.0, 5.0] - [walls.x[0, 0], walls.y[0, 0]]
    place = own + scale * away * [1.0, -1.0]
    ink, red = (34, 38, 42), (194, 24, 91)  # --text and --alert
    assert ink in colors_near(driver, place)
    assert red not in colors_near(driver, place)
    seek(driver, when + 4.0)
    wait_for(lambda: red in colors_near(driver, place))
    assert "hit an obstacle" in driver.find_element(By.CSS_SELECTOR, "#havs li").text
    press(driver, "]")
    wait_for(lambda: f"at {when:.1f} s, segment 0" in named(driver, "figures").text)


def test_reserved_areas_are_drawn_and_ends_are_named(page, trajectories):
    driver, shown = page("reserved"), trajectories["reserved"]
    when = shown.hit_step[1, 0] * shown.dt
    texts = [event["text"] for event in state(driver, "events")]
    assert texts == ["HAV 0: obstacle collision", "HAV 1 arrived at goal 1", "time was up"]
    inside = place_of(driver, 1) - [0.0, 30.0]  # above the HAV, within what it has reserved
    before = colors_near(driver, inside)
    named(driver, "reserved").click()
    wait_for(lambda: colors_near(driver, inside) != before)
    named(driver, "reserved").click()
    assert "area that a HAV has reserved" in named(driver, "signs").text
    seek(driver, when)
    wait_for(lambda: "1 of 2 arrived" in named(driver, "phase").text)
    assert "arrived" in driver.find_elements(By.CSS_SELECTOR, "#havs li")[1].text
    assert "time was up" not in named(driver, "phase").text
    seek(driver, state(driver, "duration"))
    wait_for(lambda: "time was up" in named(driver, "phase").text)


def test_the_chart_forgets_where_the_cursor_was_and_takes_there(page):
    driver = page("single")
    press(driver, "]")
    wait_for(lambda: named(driver, "chart").is_displayed())
    pictures = []
    for moment in (20, 60, 20):
        seek(driver, moment)
        script = "return document.getElementById('chart').toDataURL()"
        pictures.append(driver.execute_script(script))
    assert pictures[0] == pictures[2] != pictures[1]
    named(driver, "chart").click()  # its middle, a little to the left of the middle of the plot
    assert state(driver, "time") / state(driver, "duration") == pytest.approx(0.45, abs=0.06)


@pytest.mark.parametrize(("scheme", "ground"), [("light", (251, 251, 249)), ("dark", (21, 24, 27))])
def test_the_colours_follow_the_system(scheme, ground, page):
    driver = page("swarm")
    driver.execute_cdp_cmd(
        "Emulation.setEmulatedMedia",
        {"features": [{"name": "prefers-color-scheme", "value": scheme}]},
    )
    wait_for(lambda: ground in colors_of(driver, "plane"))


def test_an_episode_of_one_step_can_be_shown(page):
    driver = page("moment")
    press(driver, "]", Keys.SPACE)
    wait_for(lambda: not state(driver, "playing"))
    assert state(driver, "time") == pytest.approx(0.2)


def test_the_page_is_one_file_that_asks_for_nothing():
    text = template()
    assert text.count("__") == 2  # where the episode belongs
    for part in ("http:", "https:", "import ", "fetch(", "@import", "url(", "src="):
        assert part not in text, part
