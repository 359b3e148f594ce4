"""A browser, episodes to replay, and their pages."""

import shutil

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from baselines.policies.avoid_jack import AvoidJack
from baselines.policies.dubins_pursuit import DubinsPursuit
from baselines.replay.trajectory import Trajectory, record_trajectory
from baselines.replay.web_page import write_replay
from hav_env import OffAxle, RandomPoses, Rectangles, Task, catalogue_fleet
from tests.browser.page_driver import state, wait_for
from tests.support.budgets import budget
from tests.support.recorded import arrives_in_reserved_area, driven_into_wall

SINGLE, PAIR, SWARM = (RandomPoses(num_havs=count) for count in (1, 2, 50))
# carts on drawbars; fifth wheels ahead of axles
REAL = RandomPoses(num_havs=4, fleet=catalogue_fleet(["baggage-train", "a-double"]))
OPTIONS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update", "--window-size=1200,800"),
)


def program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        pytest.fail(f"{name} is missing: apt-get install chromium chromium-driver")
    return path


@pytest.fixture(scope="module")
def chromium(tmp_path_factory):
    options = webdriver.ChromeOptions()
    options.binary_location = program("chromium")
    for option in (*OPTIONS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(option)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    # with the driver's path, Selenium does not search elsewhere
    driver = webdriver.Chrome(options=options, service=Service(program("chromedriver")))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def trajectories() -> dict[str, Trajectory]:
    steps = Task(max_steps=400)
    return {
        "single": record_trajectory(AvoidJack(), SINGLE, 0, 997, steps),  # jackknifes at step 381
        "pair": record_trajectory(AvoidJack(), PAIR, 0, 5, steps),  # evades from step 330 on
        "swarm": record_trajectory(AvoidJack(), SWARM, 0, 0, Task(max_steps=budget(200, 3))),
        "left": record_trajectory(  # HAV 1 hits its goal in step 174
            DubinsPursuit(),
            RandomPoses(2, num_goals=1),
            0,
            14,
            Task(max_steps=180, on_goal="remove"),
        ),
        "real": record_trajectory(
            AvoidJack(), REAL, 0, 0, Task(max_steps=budget(200, 20)), OffAxle(bodies=Rectangles())
        ),
        "hitched": record_trajectory(AvoidJack(), REAL, 0, 0, Task(max_steps=20), OffAxle()),
        "walls": driven_into_wall(),
        "reserved": arrives_in_reserved_area(),
        "moment": record_trajectory(AvoidJack(), SINGLE, 0, 0, Task(max_steps=1)),
    }


@pytest.fixture(scope="module")
def pages(trajectories, tmp_path_factory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("pages")
    for name, trajectory in trajectories.items():
        write_replay(trajectory, folder / f"{name}.html")
    return {name: (folder / f"{name}.html").as_uri() for name in trajectories}


@pytest.fixture
def page(chromium, pages):
    """Return a function that opens a page; afterwards the browser must have logged no error."""

    def open_page(name: str) -> webdriver.Chrome:
        chromium.get(pages[name])
        wait_for(lambda: state(chromium, "vehiclesDrawn") > 0)
        return chromium

    chromium.get_log("browser")
    chromium.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    yield open_page
    # "rendering" reports that the test reads pixels, which is slow
    complaints = [entry for entry in chromium.get_log("browser") if entry["source"] != "rendering"]
    assert complaints == []
    # the page read one file only
    assert chromium.execute_script("return performance.getEntriesByType('resource').length") == 0
