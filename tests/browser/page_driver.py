"""Actions of a user on the replay page, and readings of its contents."""

import time

import numpy as np
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

PATIENCE = 20.0  # s


def state(driver, name: str):
    return driver.execute_script(f"return window.replay.{name}")


def wait_for(condition) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, "the page does not get there"
        time.sleep(0.02)


def named(driver, name: str):
    return driver.find_element(By.ID, name)


def press(driver, *keys: str) -> None:
    ActionChains(driver).send_keys(*keys).perform()


def seek(driver, moment: float) -> None:
    driver.execute_script(
        "const s = document.getElementById('scrub'); s.value = arguments[0];"
        "s.dispatchEvent(new Event('input'))",
        moment,
    )
    wait_for(lambda: drawn_time(driver) == f"{moment:.1f} s")


def drawn_time(driver) -> str:
    return named(driver, "clock").text.partition(" /")[0]


def place_of(driver, hav: int) -> np.ndarray:
    return np.array(driver.execute_script(f"return window.replay.positionOf({hav})"))


def colors_near(driver, place) -> set[tuple[int, ...]]:
    """Return the colours of the plane within two pixels of a place on the page."""
    script = (
        "const c = document.getElementById('plane'), box = c.getBoundingClientRect();"
        "const k = devicePixelRatio || 1, [x, y] = arguments;"
        "const [left, top] = [Math.floor(k * (x - box.left)), Math.floor(k * (y - box.top))];"
        "return [...c.getContext('2d').getImageData(left - 2, top - 2, 5, 5).data]"
    )
    pixels = driver.execute_script(script, *map(float, place))
    return {tuple(color) for color in np.reshape(pixels, (-1, 4))[:, :3].tolist()}


def click_at(driver, place) -> None:
    actions = ActionChains(driver)
    actions.w3c_actions.pointer_action.move_to_location(*(round(value) for value in place))
    actions.w3c_actions.pointer_action.click()
    actions.perform()


def colors_of(driver, canvas: str) -> set[tuple[int, ...]]:
    """Return the colours on a canvas."""
    pixels = driver.execute_script(
        "const c = document.getElementById(arguments[0]);"
        "const d = new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height)"
        ".data.buffer);"
        "return [...new Set(d)]",
        canvas,
    )
    return {tuple((pixel >> shift) & 255 for shift in (0, 8, 16)) for pixel in pixels}
