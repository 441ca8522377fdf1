# SPDX-License-Identifier: GPL-3.0-or-later
"""The lessons in a real browser: pointer, keys and touch in headless Chromium.

test_page.py PROGRAM WORK, where PROGRAM is lagrain and WORK a folder for the pages. Nothing depends
on how long anything takes. Exit code 77: the browser, its driver or the compiled module is missing.
"""

import pathlib
import shutil
import subprocess
import sys
import time

SKIPPED = 77
PROGRAM, WORK = sys.argv[1], pathlib.Path(sys.argv[2])


def skip(why):
    print("SKIPPED: " + why)
    sys.exit(SKIPPED)


try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select
except ImportError:
    skip("python3-selenium is not installed")
if not shutil.which("chromium") or not shutil.which("chromedriver"):
    skip("chromium and chromium-driver are not installed")

shutil.rmtree(WORK, ignore_errors=True)
subprocess.run([PROGRAM, "teach", "--out", str(WORK)], check=True, stdout=subprocess.DEVNULL,
               stderr=subprocess.DEVNULL)
if not (WORK / "lagrain.js").exists():
    skip("the library was not compiled for browsers (emscripten)")


def expect(same, what):
    if not same:
        raise SystemExit(f"{page.current}: {what}")


class Browser:
    """Chromium without a window."""

    def __init__(self):
        options = webdriver.ChromeOptions()
        for flag in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
            options.add_argument(flag)
        options.binary_location = shutil.which("chromium")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")),
                                       options=options)
        self.current = ""

    def size(self, width, height):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})

    def open(self, name):
        """Opens a page from disk, and waits until its benches have started."""
        self.current = name
        self.driver.get((WORK / name).as_uri())
        if name != "index.html":
            self.wait("return document.documentElement.dataset.started", "it did not start")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def wait(self, script, what):
        """Waits for a condition: a minute is more than the slowest machine needs."""
        for _ in range(600):
            if self.run(script):
                return
            time.sleep(0.1)
        expect(False, what)

    def find(self, selector, number=0):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)[number]

    def bench(self, expression, number=0):
        return self.run(f"const bench = window.lagrain.benches[{number}]; return {expression};")

    def text(self, selector, number=0):
        return self.find(selector, number).text

    def click(self, element):
        self.run("arguments[0].scrollIntoView({ block: 'center', behavior: 'instant' })", element)
        element.click()

    def drag(self, x0, y0, x1, y1, number=0):
        """Drags from one place of a bench's world to another, with the pointer."""
        canvas = self.find(".bench canvas", number)
        self.run("arguments[0].scrollIntoView({ block: 'center', behavior: 'instant' })", canvas)
        at = [self.bench(f"[bench.stage.x({x}) / bench.canvas.width, "
                         f"bench.stage.y({y}) / bench.canvas.height]", number)
              for x, y in ((x0, y0), (x1, y1))]
        width, height = canvas.size["width"], canvas.size["height"]
        moves = [(round((u - 0.5) * width), round((v - 0.5) * height)) for u, v in at]
        hands = ActionChains(self.driver, duration=50)
        hands.move_to_element_with_offset(canvas, *moves[0]).click_and_hold()
        for part in (0.25, 0.5, 0.75, 1):
            between = [round(a + part * (b - a)) for a, b in zip(*moves)]
            hands.move_to_element_with_offset(canvas, *between)
        hands.release().perform()

    def keys(self, *keys, number=0):
        self.find(".bench canvas", number).send_keys(*keys)

    def check_console(self):
        trouble = [entry["message"] for entry in self.driver.get_log("browser")
                   if entry["level"] in ("SEVERE", "WARNING")]
        expect(not trouble, f"the console says {trouble}")


page = Browser()
LESSONS = sorted(file.name for file in WORK.glob("[0-9][0-9]_*.html"))


def done(selector):
    return "done" in page.find(selector).get_attribute("class")


def check_every_page():
    """What holds for all pages: no request leaves, nothing is wider than a phone, all is named."""
    expect(len(LESSONS) == 12, f"{len(LESSONS)} lessons")
    for name in ["index.html", "playground.html", *LESSONS]:
        for width in (1200, 360):
            page.size(width, 800)
            page.open(name)
            wide = page.run("return document.documentElement.scrollWidth - innerWidth")
            expect(wide <= 0, f"{wide} pixels wider than {width}")
            foreign = page.run(
                "return performance.getEntriesByType('resource').map(e => e.name)"
                ".filter(name => !/^(file|data|blob):/.test(name))")
            expect(not foreign, f"asks for {foreign}")
            expect(page.run("return [...document.images].every(i => i.complete && i.naturalWidth)"),
                   "a picture is not there")
            nameless = page.run(
                "return [...document.querySelectorAll('input, select, textarea, canvas')]"
                ".filter(e => !e.labels?.length && !e.getAttribute('aria-label'))"
                ".map(e => e.outerHTML.slice(0, 80))")
            expect(not nameless, f"without a name: {nameless}")
            small = page.run(
                "return [...document.querySelectorAll('button, select, summary, input[type=text]')]"
                ".filter(e => e.offsetHeight && e.offsetHeight < 44).map(e => e.outerHTML)")
            expect(not small, f"too small for a finger: {small}")
            expect(page.run("return document.querySelectorAll('main').length") == 1 and
                   page.run("return document.documentElement.lang") == "en", "main or language")
            expect(not page.run("return [...document.querySelectorAll('.trouble')]"
                                ".some(e => !e.hidden)"), "a bench is in trouble")
            page.check_console()
    broken = [(name, link) for name in ["index.html", *LESSONS]
              for link in links_of(name) if not (WORK / link).exists()]
    expect(not broken, f"links that lead nowhere: {broken}")


def links_of(name):
    page.size(1200, 900)
    page.open(name)
    return page.run("return [...document.links].map(l => l.getAttribute('href'))"
                    ".filter(h => !h.startsWith('#'))")


def check_misprint():
    page.open("07_theorem.html")
    expect(page.bench("bench.missed") == 1, "the misprint misses one contact")
    expect("not r²" in page.text(".why"), "it says why: " + page.text(".why"))
    unit = page.find(".controls input[type=range]")
    unit.send_keys(Keys.END)
    expect(page.bench("bench.missed") == 0, "in a larger unit it is found")
    expect(done("[data-build]"), "the exercise is not done")
    page.open("07_theorem.html")
    Select(page.find(".controls select")).select_by_value("0")
    expect(page.bench("bench.missed") == 0, "r² misses none")
    expect("No contact is missed" in page.text(".why"), "and says so")
    expect(not done("[data-build]"), "an exercise that was not asked is done")


def check_drag():
    page.open("08_motion.html")
    before = page.bench("JSON.stringify(bench.edges)")
    x, y = page.bench("bench.discs[0]")[:2]
    page.drag(x, y, 1 - x, 0.7 - y)
    expect(page.bench("JSON.stringify(bench.edges)") != before, "a drag changes edges")
    expect("Disc 0" in page.text(".said"), "and says so: " + page.text(".said"))
    expect(page.bench("bench.missed") == 0, "T that follows misses none")
    page.click(page.find(".controls input[type=checkbox]", 2))  # T stands still
    expect(page.bench("bench.still") is True, "T stands still")
    for k in range(1, 16):
        if done("[data-build]"):
            break
        # Into a gap between two others: to the middle between their centres.
        place = page.bench(f"[0, 1].map(d => (bench.discs[{k}][d] + bench.discs[{(k + 5) % 16}][d])"
                           " / 2)")
        here = page.bench("bench.discs[0]")
        page.drag(here[0], here[1], *place)
    expect(done("[data-build]"), "T that stands still misses two contacts")
    expect("stands still" in page.text(".why"), "and says why: " + page.text(".why"))


def check_hidden():
    page.open("06_hidden.html")
    expect(page.bench("bench.hidden.size") == 1, "one disc is hidden")
    page.drag(0, 0, 1.9, 1.9)
    expect(page.bench("bench.hidden.size") == 0, "it can be pulled out")
    expect(done("[data-build]"), "the exercise is not done")
    expect("come" in page.text(".said"), "its edges come: " + page.text(".said"))


def check_keyboard():
    page.open("10_ties.html")
    expect(page.bench("bench.edges.some(([a, b]) => a === 1 && b === 3)"), "the rule for ties")
    page.keys(Keys.SHIFT, Keys.ARROW_RIGHT)
    page.keys(Keys.NULL)
    expect(done("[data-build]"), "a move by a hair changes the diagonal")
    page.keys("]")
    expect("Disc 1 of 9" in page.text(".said"), "brackets choose: " + page.text(".said"))
    radius = page.bench("bench.discs[1][2]")
    page.keys("+")
    expect(page.bench("bench.discs[1][2]") > radius, "plus makes it larger")
    page.keys("n")
    expect(page.bench("bench.discs.length") == 10, "n adds one")
    page.keys(Keys.DELETE)
    expect(page.bench("bench.discs.length") == 9, "Delete removes it")
    page.open("02_lifting.html")
    page.keys("[", "-", "-", "-", "-", "-")
    page.keys("[", "-", "-", "-", "-", "-")
    for _ in range(20):
        if done("[data-build]"):
            break
        page.keys("-")
    expect(done("[data-build]"), "lifted sites by keys")
    page.open("04_flips.html")
    for _ in range(40):
        if page.bench("bench.badLeft") == 0:
            break
        which = page.bench("bench.bad.findIndex((b, k) => b && bench.possible(bench.inner[k]))")
        while page.bench("bench.chosen") != which:
            page.keys("]")
        page.keys(Keys.ENTER)
    expect(page.bench("bench.badLeft") == 0, "flips by keys lead to T")
    page.open("05_space.html")
    Select(page.find(".controls select")).select_by_value("2")
    page.keys(Keys.ENTER, Keys.ARROW_LEFT)
    expect(done("[data-build]"), "a flip in space by keys")


def check_touch():
    page.size(390, 800)
    page.open("01_power.html")
    canvas = page.find(".bench canvas")
    page.run("arguments[0].scrollIntoView({ block: 'center', behavior: 'instant' })", canvas)
    at = page.run("const b = arguments[0].getBoundingClientRect(); return [b.left, b.top, b.width,"
                  " b.height]", canvas)
    place = [page.bench(f"[bench.stage.x({x}) / bench.canvas.width, "
                        f"bench.stage.y({y}) / bench.canvas.height]") for x, y in ((4, 0), (1.3, 0))]
    points = [[at[0] + u * at[2], at[1] + v * at[3]] for u, v in place]

    def touch(kind, point):
        touches = [{"x": point[0], "y": point[1]}] if point else []
        page.driver.execute_cdp_cmd("Input.dispatchTouchEvent",
                                    {"type": kind, "touchPoints": touches})

    touch("touchStart", points[0])
    for part in (0.3, 0.6, 1):
        touch("touchMove", [a + part * (b - a) for a, b in zip(*points)])
    touch("touchEnd", None)
    expect(page.bench("bench.discs[1][0]") < 2, "a finger moves a disc")
    expect(done("[data-build]"), "disc 0 lies outside its own cell")
    page.size(1200, 900)


def check_bad_inputs():
    page.open("playground.html")
    for discs, word in (("[[NaN, 0, 1], [1, 0, 1]]", "number"),
                        ("Array.from({ length: 10000 }, (_, k) => [k, 0, 1])", "discs"),
                        ("[[1, 1, 1], [1, 1, 1], [1, 1, 1]]", "one point"),
                        ("[[0, 0, 0], [1, 0, 1]]", "radius")):
        page.run(f"window.lagrain.benches[0].build({discs})")
        trouble = page.text(".trouble")
        expect(word in trouble and trouble.count("\n") == 0, f"{discs}: it says \"{trouble}\"")
        expect(page.bench("bench.discs.length") == 24, "the discs are what they were")
        page.run("window.lagrain.benches[0].restart()")
        expect(not page.find(".trouble").is_displayed(), "the page goes on")
    page.run("window.lagrain.benches[1].attempt(() => "
             "window.lagrain.library.call('grains_start', 0, -3, 1, 0.3, 0.5))")
    expect("grains" in page.text(".trouble", 1), "a bad number of grains is a sentence")
    page.run("window.lagrain.benches[1].restart()")


def check_grains():
    page.open("playground.html")
    page.run("window.lagrain.benches[1].run(false);"
             "for (let k = 0; k < 30; ++k) window.lagrain.library.call('grains_step', 100);"
             "window.lagrain.benches[1].draw()")
    expect(page.bench("bench.audited", 1) > 0, "contacts are audited")
    expect(page.bench("bench.missed", 1) == 0, "none is missed")
    expect(page.bench("Math.abs(bench.ledger.residual) < 0.01 * bench.ledger.gravity", 1),
           "the ledger closes")
    time_before = page.bench("bench.time", 1)
    page.run("window.lagrain.benches[1].canvas.scrollIntoView({ behavior: 'instant' });"
             "window.lagrain.benches[1].run(true)")
    page.wait(f"return window.lagrain.benches[1].time > {time_before}", "time goes on")
    page.run("window.lagrain.benches[1].run(false)")
    # A T that stands still lets grains pass through each other unseen.
    page.run("const b = window.lagrain.benches[1]; b.settings.follow = false; b.restart();"
             "b.run(false);"
             "for (let k = 0; k < 60; ++k) { window.lagrain.library.call('grains_step', 200);"
             "b.draw(); if (b.missed) break; }")
    expect(page.bench("bench.missed", 1) > 0, "without following, contacts are missed")
    expect("stands still" in page.text(".why", 1), "and it says why")


def check_answers():
    page.open("01_power.html")
    field, button = page.find("[data-answer] input"), page.find("[data-answer] button")
    field.send_keys("2")
    page.click(button)
    expect("Not yet" in page.text("[data-answer] .verdict"), "a wrong answer")
    field.clear()
    field.send_keys(page.find("[data-answer]").get_attribute("data-answer").replace(".", ","),
                    Keys.ENTER)
    expect("Right" in page.text("[data-answer] .verdict"), "a right answer, with a comma")
    for name in LESSONS:
        page.open(name)
        for number in range(len(page.driver.find_elements(By.CSS_SELECTOR, "[data-answer]"))):
            answer = page.find("[data-answer]", number).get_attribute("data-answer")
            page.find("[data-answer] input", number).send_keys(f"{float(answer):.4g}", Keys.ENTER)
            expect("Right" in page.text("[data-answer] .verdict", number),
                   f"four digits of {answer} do not do")
    page.open("11_dem.html")
    code, check = page.find("[data-code] textarea"), page.find("[data-code] button")
    page.click(check)
    expect("is right" in page.text("[data-code] .verdict"), "a wrong force is shown where it fails")
    code.clear()
    code.send_keys("if (u <= 0) return 0; return Math.max(0, k * u + c * v);")
    page.click(check)
    expect("Right at" in page.text("[data-code] .verdict"), page.text("[data-code] .verdict"))
    page.open("03_exactness.html")
    for axis, value in ((2, "0.25"), (3, "0.25"), (4, "1"), (5, "1")):
        field = page.find(".controls input", axis)
        field.clear()
        field.send_keys(value, Keys.TAB)
    expect(done("[data-build]"), "a map without wrong signs")
    page.open("09_lazy.html")
    page.find(".controls input[type=range]").send_keys(Keys.END)
    expect(done("[data-build]"), "edges that fail the certificate")
    page.open("12_speed_and_error.html")
    for _ in range(35):
        page.find(".controls input[type=range]", 1).send_keys(Keys.ARROW_RIGHT)
    expect(done("[data-build]"), "an error below one in ten thousand")


def check_without_scripts():
    page.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    page.driver.get((WORK / LESSONS[0]).as_uri())
    expect(page.find(".bench img").is_displayed(), "the still picture stays")
    page.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


try:
    page.size(1200, 900)
    for check in (check_every_page, check_misprint, check_drag, check_hidden, check_keyboard,
                  check_touch, check_bad_inputs, check_grains, check_answers):
        check()
        page.check_console()
        print(check.__name__ + ": good")
    check_without_scripts()
    print("check_without_scripts: good")
finally:
    page.driver.quit()
