"""Opens a report in headless Chromium as its reader would, and says what is wrong with it.

usage: report_browser.py RUN_REPORT.html STUDY.csv CASE_REPORT.html MEASUREMENT_REPORT.html

Ends with 77 where Chromium or Selenium are missing, with 1 where something is wrong."""

import csv
import json
import math
import pathlib
import shutil
import sys

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("skipped: python3-selenium is not installed")
    sys.exit(77)
if not shutil.which("chromium") or not shutil.which("chromedriver"):
    print("skipped: chromium and chromium-driver are not installed")
    sys.exit(77)

misses = []


def expect(holds, what):
    if not holds:
        misses.append(what)
        print("miss:", what)


def browser():
    options = webdriver.ChromeOptions()
    for argument in ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1200,1600"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


def open_page(driver, path):
    driver.get(pathlib.Path(path).resolve().as_uri())
    errors = [entry["message"] for entry in driver.get_log("browser") if entry["level"] == "SEVERE"]
    expect(not errors, f"{path}: errors in the console: {errors}")
    urls = []
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            urls.append(message["params"]["request"]["url"])
    fetched = [url for url in urls if not url.startswith(("file:", "data:"))]
    expect(len(urls) > 0, f"{path}: no request is seen, so that none can be missed")
    expect(not fetched and sum(url.startswith("file:") for url in urls) == 1, f"{path}: fetches {urls}")


def spoken(driver):
    return driver.find_element(By.ID, "spoken").get_attribute("textContent")


def check_charts(driver, kinds):
    charts = driver.find_elements(By.CSS_SELECTOR, "figure.chart")
    expect([chart.get_attribute("data-chart") for chart in charts] == kinds, "charts are not " + ", ".join(kinds))
    for chart in charts:
        kind = chart.get_attribute("data-chart")
        drawn = chart.find_element(By.CSS_SELECTOR, "[role=img]")
        expect(drawn.get_attribute("aria-label"), f"{kind}: no label")
        expect(any(c.isdigit() for c in chart.find_element(By.CSS_SELECTOR, ".alt").text), f"{kind}: its text has no number")
        before = spoken(driver)
        driver.execute_script("arguments[0].focus()", drawn)
        ActionChains(driver).send_keys(Keys.ARROW_RIGHT).perform()
        first = spoken(driver)
        ActionChains(driver).send_keys(Keys.ARROW_RIGHT).perform()
        if kind != "layout":  # its lines have no values
            expect(first != before and spoken(driver) != first, f"{kind}: arrow keys do not read out another value")
        marks = drawn.find_elements(By.CSS_SELECTOR, "rect.mark, rect.cells")
        for mark in [mark for mark in marks if mark.rect["height"] > 4][:1]:  # a cause may be nothing
            driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", mark)
            ActionChains(driver).move_to_element(mark).perform()
            expect(driver.find_element(By.CSS_SELECTOR, ".tip").is_displayed(), f"{kind}: no value is shown at the pointer")


def check_choices(driver):
    """Another figure is drawn when it is chosen, and a layer disappears when its name in the legend is clicked."""
    for kind in ["curves", "repeats", "causes", "coverage"]:
        chart = driver.find_element(By.CSS_SELECTOR, f"figure[data-chart={kind}]")
        drawn = lambda: chart.find_element(By.CSS_SELECTOR, "svg").get_attribute("innerHTML")
        options = chart.find_elements(By.CSS_SELECTOR, "select")[0].find_elements(By.TAG_NAME, "option")
        before = drawn()
        options[-1].click()
        expect(drawn() != before, f"{kind}: another choice draws nothing else")
        options[0].click()
    causes = driver.find_element(By.CSS_SELECTOR, "figure[data-chart=causes]")
    bars = lambda: len(causes.find_elements(By.CSS_SELECTOR, "svg > g > g > rect"))
    before, entry = bars(), causes.find_elements(By.CSS_SELECTOR, ".entry")[0]
    driver.execute_script("arguments[0].dispatchEvent(new Event('click'))", entry)
    expect(0 < bars() < before, "a click on the legend hides no bars")


def check_curves(driver, cases):
    """Each point of a curve is the root mean square over the repeats in study.csv, rounded to seven digits (5e-7)."""
    data = json.loads(driver.execute_script("return document.getElementById('data').textContent"))
    figure = next(chart["figures"] for chart in data["charts"] if chart["chart"] == "curves")[0]["figure"]
    drawn = [layer["columns"][1] for layer in figure["panels"][0]["layers"] if layer["kind"] == "errors"]
    points = {}
    for case in cases:
        key = float(case["medium.field.wavelength_mm"]), float(case["lens.f_number"])
        points.setdefault(key, []).append(float(case["ray_truth.rms_px"]))
    want = [math.sqrt(sum(x * x for x in points[key]) / len(points[key])) for key in sorted(points)]
    found = [y for curve in drawn for y in curve]
    same = len(found) == len(want) and all(abs(a - b) <= 5e-7 * b for a, b in zip(found, want))
    expect(same, f"the curves are {found}, not {want}")


def check_run(driver, page, table):
    open_page(driver, page)
    check_charts(driver, ["layout", "design_map", "curves", "cells", "scatter", "repeats", "causes", "coverage", "layout"])
    ideal = "g[data-name^='68 %'] path"
    expect(driver.find_elements(By.CSS_SELECTOR, "figure[data-chart=coverage] " + ideal), "no line says what coverage is right")
    expect(not driver.find_elements(By.CSS_SELECTOR, "figure[data-chart=curves] " + ideal), "a line says what error is right")
    check_choices(driver)

    curves = driver.find_element(By.CSS_SELECTOR, "figure[data-chart=curves]")
    ticks = lambda: [tick.text for tick in curves.find_elements(By.CSS_SELECTOR, ".axis .tick text")]
    whole = ticks()
    driver.execute_script("arguments[0].focus()", curves.find_element(By.CSS_SELECTOR, "svg"))
    ActionChains(driver).send_keys("+").perform()
    expect(ticks() != whole, "the curves do not zoom by key")
    ActionChains(driver).send_keys("0").perform()
    expect(ticks() == whole, "the curves do not come back")
    box = curves.find_element(By.CSS_SELECTOR, ".overlay")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", box)
    ActionChains(driver).move_to_element_with_offset(box, -60, -60).click_and_hold().move_by_offset(120, 120).release().perform()
    expect(ticks() != whole, "the curves do not zoom by a box")

    with open(table, newline="") as file:
        cases = list(csv.DictReader(file))
    check_curves(driver, cases)

    body = driver.find_element(By.CSS_SELECTOR, "section table:last-of-type tbody")
    cells = driver.find_elements(By.CSS_SELECTOR, "table th button")
    at = [cell.text for cell in cells].index("ray_truth.rms_px")
    column = lambda: [float(row.find_elements(By.TAG_NAME, "td")[at].get_attribute("data-value")) for row in body.find_elements(By.TAG_NAME, "tr")]
    driver.execute_script("arguments[0].click()", cells[at])
    expect(column() == sorted(column()), "the table is not sorted")
    driver.execute_script("arguments[0].click()", cells[at])
    expect(column() == sorted(column(), reverse=True), "the table is not sorted backwards")
    expect(sorted(column()) == sorted(float(case["ray_truth.rms_px"]) for case in cases), "the table's numbers are not study.csv's")

    search = driver.find_element(By.CSS_SELECTOR, "input[type=search]")
    search.send_keys("no such case")
    shown = lambda: [row for row in body.find_elements(By.TAG_NAME, "tr") if row.is_displayed()]
    expect(not shown(), "the search leaves rows")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    expect(len(shown()) == len(cases), "print leaves out rows")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


def check_maps(driver):
    """All maps are drawn next to each other, so that the printed page contains them."""
    data = json.loads(driver.execute_script("return document.getElementById('data').textContent"))
    fields = next(chart["figures"] for chart in data["charts"] if chart["chart"] == "field")
    maps = driver.find_elements(By.CSS_SELECTOR, "figure[data-chart=field] .maps canvas")
    expect(len(maps) == len(fields) > 3, "the report does not contain a canvas for every map")
    painted = "const c = arguments[0]; return new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size"
    expect(driver.execute_script(painted, maps[0]) > 3, "the first map has no colours")


def check_folds(driver):
    """Settings that are folded on the screen are unfolded for printing, and folded again afterwards."""
    folded = lambda: len(driver.find_elements(By.CSS_SELECTOR, "details:not([open])"))
    before = folded()
    driver.execute_script("window.dispatchEvent(new Event('beforeprint'))")
    expect(before > 0 and folded() == 0, "print leaves settings folded away")
    driver.execute_script("window.dispatchEvent(new Event('afterprint'))")
    expect(folded() == before, "settings stay unfolded after print")


def check_measurement(driver, page):
    open_page(driver, page)
    check_charts(driver, ["layout", "design_map", "field", "budget"])
    check_maps(driver)
    check_folds(driver)
    text = driver.find_element(By.TAG_NAME, "main").text
    expect("nan" not in text.lower().split(), "a number is none")


def check_case(driver, page):
    open_page(driver, page)
    check_charts(driver, ["layout", "design_map", "field", "histogram", "budget", "reliability"])
    check_maps(driver)
    button = driver.find_element(By.CSS_SELECTOR, "figure.frames button")
    pictures = driver.find_elements(By.CSS_SELECTOR, "figure.frames img")
    shown = lambda: sum(picture.is_displayed() for picture in pictures)
    expect(shown() == 2, "the frames are not side by side")
    driver.execute_script("arguments[0].click()", button)
    expect(shown() == 1, "the frames do not take turns")
    widths = [picture.get_property("naturalWidth") for picture in pictures]
    expect(all(width > 0 for width in widths), "a picture cannot be decoded")
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
    paper = driver.execute_script("return getComputedStyle(document.body).backgroundColor")
    expect(paper == "rgb(22, 24, 28)", f"the dark page is {paper}")


def main():
    driver = browser()
    try:
        check_run(driver, sys.argv[1], sys.argv[2])
        check_case(driver, sys.argv[3])
        check_measurement(driver, sys.argv[4])
    finally:
        driver.quit()
    print("report: " + ("no misses" if not misses else f"{len(misses)} misses"))
    sys.exit(1 if misses else 0)


main()
