#!/usr/bin/env python3
"""Times of the page of `claray view` in a browser.

From the begin of the page's load to its first picture, and from the input of a slider to the first picture that shows it.

    python3 -m venv env && env/bin/pip install playwright
    env/bin/python bench/view/page.py --program build/bin/claray cornell

Playwright starts the browser of `--browser`, without a display. The image has 640x360 pixels by default: the window is as much larger
as the panel is wide, and the size is that of `Full`.
"""
import argparse
import re
import statistics
import subprocess
import time

from playwright.sync_api import Page, sync_playwright

PANEL = 316  # CSS pixels

# Waits for the first picture.
FIRST = """() => new Promise(done => {
    const image = document.getElementById("view");
    const look = () => requestAnimationFrame(() => image.dataset.revision === undefined ? look() : done(performance.now()));
    look();
})"""

# Moves the slider, and waits for a picture of that revision of the scene or a later one. Times are those of the page.
MOVE = """value => new Promise(done => {
    const image = document.getElementById("view"), slider = document.getElementById("probe");
    const before = image.dataset.revision, begin = performance.now();
    const watch = new MutationObserver(() => {
        if (image.dataset.revision === before) return;
        watch.disconnect();
        requestAnimationFrame(() => done(performance.now() - begin));
    });
    watch.observe(image, { attributeFilter: ["data-revision"] });
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
})"""


def first_picture(page: Page, url: str) -> float:
    """Milliseconds."""
    page.goto(url)
    return page.evaluate(FIRST)


def slider_times(page: Page, moves: int, rest: float) -> list[float]:
    """Milliseconds of each move of the slider of roughness or albedo; the view rests for so many seconds in between."""
    page.evaluate("""() => { document.querySelector(".row input[type=range]").closest("aside").querySelectorAll(".row").forEach(row => {
        const slider = row.querySelector("input[type=range]");
        if (slider && row.querySelector("label").textContent === "Opacity") slider.id = "probe";
    }) }""")
    times = []
    for move in range(moves):
        times.append(page.evaluate(MOVE, str(0.2 + 0.6 * (move % 7) / 7)))
        time.sleep(rest)
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("scene", nargs="?", default="cornell")
    parser.add_argument("--program", default="build/bin/claray")
    parser.add_argument("--browser", default="/usr/bin/chromium")
    parser.add_argument("--size", default="640x360", help="of the image [640x360]")
    parser.add_argument("--scale", default="1", choices=["1", "0.5", "0.25"], help="of its sides")
    parser.add_argument("--moves", type=int, default=40)
    parser.add_argument("--rest", type=float, default=0.3, help="seconds between moves [0.3]")
    options = parser.parse_args()
    width, height = (int(side) for side in options.size.split("x"))
    program = subprocess.Popen([options.program, "view", options.scene, "--port", "0", "--no-browser"], stdout=subprocess.PIPE, text=True)
    try:
        assert program.stdout is not None
        found = re.search(r"http://\S+", program.stdout.readline())
        assert found, "claray view printed no address"
        with sync_playwright() as play:
            browser = play.chromium.launch(executable_path=options.browser, args=["--no-sandbox"])
            firsts = []
            for _ in range(5):
                page = browser.new_page(viewport={"width": width + PANEL, "height": height})
                firsts.append(first_picture(page, found[0]))
                if len(firsts) < 5:
                    page.close()
            page.get_by_label("Size").select_option(options.scale)
            page.get_by_role("listbox", name="Materials").get_by_role("option").first.click()
            time.sleep(1)
            times = sorted(slider_times(page, options.moves, options.rest))
            browser.close()
        tail = times[min(len(times) - 1, round(0.95 * len(times)))]
        print(f"{options.scene}: first picture {max(firsts):.0f} ms (the slowest of {len(firsts)} pages)")
        print(f"{options.scene}: slider to picture: median {statistics.median(times):.1f} ms, 95th percentile {tail:.1f} ms, of {len(times)}")
    finally:
        program.terminate()
        program.wait()


if __name__ == "__main__":
    main()
