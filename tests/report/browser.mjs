// SPDX-License-Identifier: GPL-3.0-or-later
// Opens a report as a reader would and says what is not as it must be:
//   node browser.mjs MODULES REPORT.html SCREENSHOTS [check...]
// MODULES is the folder with node_modules/playwright-core. Without names all checks run except `quick`, which
// measures times. A report called many.html has checks of its own (browser_many.mjs).
import {mkdirSync, readFileSync, statSync} from "node:fs";
import {createRequire} from "node:module";
import {basename, join, resolve} from "node:path";
import {pathToFileURL} from "node:url";
import {layoutChecks} from "./browser_layout.mjs";
import {manyChecks} from "./browser_many.mjs";
import {runChecks} from "./browser_runs.mjs";

const [modules, report, shots] = process.argv.slice(2, 5).map((path) => resolve(path));
const wanted = process.argv.slice(5);
const {chromium} = createRequire(join(modules, "package.json"))("playwright-core");
mkdirSync(shots, {recursive: true});

const limits = {bytes: 15e6, milliseconds: 10000};
const failures = [];
const expect = (holds, what) => {
  if (holds) return;
  failures.push(what);
  console.log(`  FAILED: ${what}`);
};

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
});

// Opens the report, or `file`. The check fails if the page logs an error (unless it may fail), throws, or asks for
// anything but itself.
async function open(check, options = {}) {
  const {file = report, mayFail = false, ...context_options} = options;
  const address = pathToFileURL(file).href;
  const context = await browser.newContext({viewport: {width: 1280, height: 900}, ...context_options});
  const page = await context.newPage();
  page.on("console", (message) => {
    if (message.type() === "error" && !mayFail) expect(false, `${check}: console: ${message.text()}`);
  });
  page.on("pageerror", (error) => expect(false, `${check}: ${error.message}`));
  page.on("request", (request) => {
    const own = request.url() === address || /^(data|blob):/.test(request.url());
    expect(own, `${check}: it asks for ${request.url().slice(0, 100)}`);
  });
  await page.goto(address, {waitUntil: "load", timeout: 120_000});
  return page;
}

// The page draws a plot when it comes into view.
async function drawAllPlots(page) {
  await page.evaluate(async () => {
    for (const plot of document.querySelectorAll("[data-chart]")) {
      plot.scrollIntoView();
      for (const end = performance.now() + 30000; !plot.querySelector(".main-svg .xtick");) {
        if (performance.now() > end) throw new Error(`the plot ${plot.dataset.chart} is not drawn`);
        await new Promise(requestAnimationFrame);
      }
    }
  });
}

// The plot with most points.
async function richestPlot(page) {
  const name = await page.locator("[data-chart]").evaluateAll((hosts) => hosts
    .sort((a, b) => b.querySelectorAll(".point").length - a.querySelectorAll(".point").length)[0]
    .dataset.chart);
  const plot = page.locator(`[data-chart="${name}"]`);
  await plot.scrollIntoViewIfNeeded();
  return plot;
}

const pixels = (page) => page.locator('#packings [data-part="canvas"]').screenshot();

// The picture of the packing once it differs from `before`; that one again after five seconds.
async function nextPicture(page, before) {
  for (const end = performance.now() + 5000; performance.now() < end;) {
    const now = await pixels(page);
    if (!before.equals(now)) return now;
  }
  return before;
}

async function openPackings(page) {
  await page.locator("#packings").scrollIntoViewIfNeeded();
  await page.locator('#packings [data-part="run"] option').first().waitFor({state: "attached"});
  await page.waitForTimeout(300);
}

async function slide(page, part, value) {
  await page.locator(`#packings [data-part="${part}"]`).evaluate((slider, at) => {
    slider.value = String(at);
    slider.dispatchEvent(new Event("input", {bubbles: true}));
  }, value);
}

const checks = {
  async size() {
    const {size} = statSync(report);
    console.log(`  ${(size / 1e6).toFixed(2)} MB`);
    expect(size < limits.bytes, `size: ${size} bytes`);
  },

  // campaign.sh puts an experiment into the store whose texts are markup.
  async hostile() {
    const page = await open("hostile");
    const found = await page.evaluate(() => ({
      images: document.querySelectorAll("img").length,
      scripts: document.querySelectorAll("script").length,
      headings: [...document.querySelectorAll("h2")].map((one) => one.textContent),
      spoiled: window.spoiled === true
    }));
    const plot = page.locator('[data-chart="hostile.hostile_labels"]');
    await plot.scrollIntoViewIfNeeded();
    await plot.locator(".legendtext").first().waitFor();
    const names = await plot.locator(".legendtext").allTextContents();
    expect(names.join() === "<a href='https://example.org'>%{x}</a>,<img src=x onerror='spoiled=true'>",
      `hostile: the legend is ${names}`);
    expect(await plot.locator("a, img").count() === 0 && !(await page.evaluate(() => window.spoiled)),
      "hostile: a label became markup");
    expect(!found.spoiled && found.images === 0 && found.scripts === 2,
      `hostile: ${found.images} images, ${found.scripts} scripts`);
    expect(found.headings.some((text) => text.includes("</script><img src=x")),
      `hostile: its question is not shown as it stands: ${found.headings}`);
  },

  // Prints how long it takes; fails only beyond what any machine needs, since times differ between machines.
  async quick() {
    const times = [];
    for (let n = 0; n < 3; ++n) {
      const page = await open("quick");
      await page.locator(".main-svg .xtick").first().waitFor({state: "attached"});
      times.push(await page.evaluate(() =>
        Math.max(performance.getEntriesByType("navigation")[0].loadEventEnd, performance.now())));
    }
    console.log(`  first plot after ${times.map((t) => `${t.toFixed(0)} ms`).join(", ")}`);
    expect(Math.min(...times) < limits.milliseconds, `quick: ${times} ms`);
  },

  async plots() {
    const page = await open("plots");
    await drawAllPlots(page);
    const plots = await page.locator("[data-chart]").evaluateAll((hosts) => hosts.map((host) => ({
      name: host.dataset.chart,
      symbols: host.querySelectorAll(".scatterlayer .point, .scatterlayer .js-line").length,
      empty: /^(no data yet|Nothing is drawn in )/.test(host.querySelector(".annotation-text")?.textContent ?? ""),
      sizes: [...new Set([...host.querySelectorAll(".xtick text, .ytick text")].map((one) => getComputedStyle(one).fontSize))],
      labels: [...host.querySelectorAll(".xtitle, .ytitle")].map((label) => label.textContent)
    })));
    expect(plots.length > 0, "plots: none");
    expect(plots.some((plot) => plot.symbols > 0), "plots: no data in any");
    for (const {name, symbols, empty, labels, sizes} of plots) {
      expect(sizes.length === 1, `plots: tick labels of ${name} have the sizes ${sizes}`);
      expect(symbols > 0 || empty, `plots: ${name} shows neither data nor that there are none`);
      expect(labels.every((label) => label.length > 3 && !/[{}\\]/.test(label)),
        `plots: labels of ${name}: ${labels}`);
    }
    console.log(`  ${plots.length} plots, ${plots.reduce((sum, p) => sum + p.symbols, 0)} points`);
    await page.screenshot({path: join(shots, "report.png"), fullPage: true, timeout: 120_000});
    await page.evaluate(() => scrollTo(0, 0));
    await page.screenshot({path: join(shots, "top.png")});
  },

  // Without the script that names the theme, as in a report of drawings.
  async tints() {
    const page = await open("tints", {colorScheme: "dark"});
    const [shown, own] = await page.evaluate(() => {
      delete document.documentElement.dataset.theme;
      const tint = document.querySelector(".tint");
      const colour = () => getComputedStyle(tint).color;
      const before = colour();
      tint.style.setProperty("--tint-part", "100%");
      return [before, colour()];
    });
    expect(shown !== own, `tints: ${shown} on a dark page`);
  },

  async interaction() {
    const page = await open("interaction");
    await drawAllPlots(page);
    const plot = await richestPlot(page);
    const canvas = plot.locator(".canvas");
    const ticks = () => canvas.locator(".xtick, .ytick").allTextContents().then((texts) => texts.sort().join());
    const until = async (what, holds) => {
      for (let k = 0; k < 20 && !(await holds()); ++k) await page.waitForTimeout(100);
      expect(await holds(), `interaction: ${what}`);
    };

    const box = await canvas.locator(".nsewdrag").boundingBox();
    const point = await canvas.locator(".point").first().boundingBox();
    await page.mouse.move(point.x + point.width / 2, point.y + point.height / 2);
    await until("no values", async () => /=/.test(await canvas.locator(".hoverlayer").textContent()));

    const before = await ticks();
    await page.mouse.move(box.x + box.width * 0.3, box.y + box.height * 0.3);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.7, box.y + box.height * 0.6, {steps: 4});
    await page.mouse.up();
    await until("a dragged rectangle does not zoom", async () => await ticks() !== before);
    // On a loaded machine two clicks may come too slowly for a double click.
    for (let k = 0; k < 5 && await ticks() !== before; ++k) {
      await page.mouse.dblclick(box.x + box.width * 0.5, box.y + box.height * 0.5);
      await page.waitForTimeout(500);
    }
    expect(await ticks() === before, "interaction: a double click does not show all");

    const symbols = () => canvas.locator(".scatterlayer .point").count();
    const all = await symbols();
    await canvas.locator(".legendtoggle").first().click();
    await until("the legend hides nothing", async () => await symbols() < all);
    await page.waitForTimeout(400);  // not a double click
    await canvas.locator(".legendtoggle").first().focus();
    await page.keyboard.press("Enter");
    await until("Enter on the legend does not bring it back", async () => await symbols() === all);

    const saved = page.waitForEvent("download");
    await plot.getByRole("button", {name: /Save as SVG/}).click();
    const file = await (await saved).path();
    const text = readFileSync(file, "utf8");
    expect(!text.includes("16.25px"), "interaction: the saved SVG has larger tick labels");
    expect(text.startsWith("<svg") && text.includes("<path") && !/<style|var\(/.test(text),
      "interaction: the saved SVG needs the page's style");
    const shot = await browser.newPage();
    await shot.setContent(text);
    expect(await shot.locator(".scatterlayer .point").first().evaluate((mark) => getComputedStyle(mark).stroke !== "none"),
      "interaction: the saved SVG has no symbols");
    await shot.locator("body > svg").screenshot({path: join(shots, "saved-plot.png")});
    await shot.close();
  },

  async keyboard() {
    const page = await open("keyboard");
    await drawAllPlots(page);
    const plot = await richestPlot(page);
    const canvas = plot.locator(".canvas");
    // By Tab alone, back from its first button.
    await plot.getByRole("button", {name: "Zoom in"}).focus();
    for (let k = 0; k < 40 && !(await canvas.evaluate((it) => document.activeElement === it)); ++k) {
      await page.keyboard.press("Shift+Tab");
    }
    expect(await canvas.evaluate((it) => document.activeElement === it), "keyboard: Tab does not reach the plot");
    const outline = await canvas.evaluate((it) => getComputedStyle(it).outlineStyle);
    expect(outline !== "none", "keyboard: the focus cannot be seen");
    await page.keyboard.press("ArrowRight");
    const status = plot.locator("[role=status]");
    const first = await status.textContent();
    await page.keyboard.press("ArrowRight");
    const second = await status.textContent();
    expect(/=/.test(first) && first !== second, `keyboard: values: '${first}', '${second}'`);
    expect(/=/.test(await canvas.locator(".hoverlayer").textContent()), "keyboard: the values are not shown");
    const ticks = () => canvas.locator(".xtick, .ytick").allTextContents().then((texts) => texts.sort().join());
    const until = async (what, holds) => {
      for (let k = 0; k < 20 && !(await holds()); ++k) await page.waitForTimeout(100);
      expect(await holds(), `keyboard: ${what}`);
    };
    const before = await ticks();
    await page.keyboard.press("+");
    await until("+ does not zoom", async () => await ticks() !== before);
    await page.keyboard.press("0");
    await until("0 does not show all", async () => await ticks() === before);

    const lineage = page.locator("details.lineage").first();
    await lineage.locator("summary").first().focus();
    await page.keyboard.press("Enter");
    expect(await lineage.getAttribute("open") !== null, "keyboard: lineage does not open");

    await openPackings(page);
    const view = page.locator('#packings [data-part="canvas"]');
    await view.focus();
    const still = await pixels(page);
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("ArrowLeft");
    expect(await nextPicture(page, still) !== still, "keyboard: arrows do not turn the packing");
  },

  async lineage() {
    const page = await open("lineage");
    const lineage = page.locator("details.lineage").first();
    await lineage.locator("summary").first().click();
    const text = await lineage.innerText();
    for (const part of ["event", "manifest", "shearcell show", "computed by"]) {
      expect(text.includes(part), `lineage: does not tell '${part}'`);
    }
    await lineage.screenshot({path: join(shots, "lineage.png")});
    await lineage.locator("td a.id").first().click();
    await page.waitForTimeout(100);
    expect(await page.locator("details.run[open]").count() === 1, "lineage: its run does not open");
  },

  async packings() {
    const page = await open("packings");
    await openPackings(page);
    const box = page.locator("#packings .viewer");
    let picture = await pixels(page);
    await box.screenshot({path: join(shots, "packing.png")});
    expect(picture.length > 20000, "packings: the picture is all but empty");
    const changes = async (what, action) => {
      await action();
      const next = await nextPicture(page, picture);
      expect(next !== picture, `packings: ${what} changes nothing`);
      picture = next;
    };
    await changes("the slider", () => slide(page, "cycle", 0));
    const name = await page.locator('#packings [data-part="cycle-text"]').textContent();
    expect(/^(cycle|state) 0/.test(name), `packings: the first one is '${name}'`);

    const choose = (part, value) => page.locator(`#packings [data-part="${part}"]`).selectOption(value);
    await changes("colour by q6", () => choose("colour", "q6"));
    await box.screenshot({path: join(shots, "packing-q6.png")});
    await changes("colour by phi_local", () => choose("colour", "phi_local"));
    for (const field of ["lattice", "grain_pressure_Pa", "contacts", "displacement_d", "overlap"]) {
      await changes(`colour by ${field}`, () => choose("colour", field));
    }
    await changes("colour by class", () => choose("colour", "structure"));
    await choose("profile", "phi");
    const profile = page.locator("#packings .profile");
    const line = await profile.locator(".scatterlayer .js-line").getAttribute("d");
    expect(line.split("L").length > 5, `profile: ${line}`);
    await box.screenshot({path: join(shots, "packing-profile.png")});
    await choose("profile", "pressure");
    await page.waitForTimeout(300);
    expect(await profile.locator(".scatterlayer .js-line").getAttribute("d") !== line, "profile: does not change");
    await choose("profile", "none");
    expect(!(await profile.isVisible()), "profile: it stays");
    await changes("hiding wall grains", () => page.locator('#packings [data-part="walls"]').uncheck());
    await changes("hiding the cell", () => page.locator('#packings [data-part="box"]').uncheck());
    await changes("small disordered grains", () => choose("disordered", "small"));
    await changes("full size again", () => choose("disordered", "full size"));
    await changes("a clip plane", () => choose("cut-axis", "x"));
    await changes("moving it", () => slide(page, "cut-at", 250));
    await changes("its other side", () => page.locator('#packings [data-part="cut-side"]').check());
    await box.screenshot({path: join(shots, "packing-cut.png")});
    await changes("no clip plane", () => choose("cut-axis", "none"));
    await changes("a drag", async () => {
      const area = await page.locator('#packings [data-part="canvas"]').boundingBox();
      await page.mouse.move(area.x + area.width / 2, area.y + area.height / 2);
      await page.mouse.down();
      await page.mouse.move(area.x + area.width / 2 + 90, area.y + area.height / 2 + 30, {steps: 4});
      await page.mouse.up();
    });
    await page.locator('#packings [data-part="reset"]').click();
    // The click may have scrolled the page, and a late layout takes the grain away from the pointer.
    let answer = "";
    for (let k = 0; k < 20 && !answer.startsWith("grain"); ++k) {
      const area = await page.locator('#packings [data-part="canvas"]').boundingBox();
      await page.mouse.move(area.x + area.width / 2 + k % 2, area.y + area.height / 2);
      answer = await page.locator('#packings [data-part="grain"]').textContent();
      if (!answer.startsWith("grain")) await page.waitForTimeout(100);
    }
    expect(/grain \d+: .*q6 = /.test(answer), `packings: pointing shows '${answer}'`);
    const runs = await page.locator('#packings [data-part="run"] option').count();
    for (let run = 0; run < runs; ++run) {
      await choose("run", String(run));
      const key = await page.locator('#packings [data-part="key"]').textContent();
      const facts = await page.locator('#packings [data-part="facts"]').textContent();
      expect(/disordered \d+of all \d+ grains/.test(key), `packings: run ${run} shows '${key}'`);
      expect(/% of the interior grains crystalline/.test(facts), `packings: run ${run} states '${facts}'`);
    }
    console.log(`  ${runs} runs`);
  },

  async themes() {
    const colours = {};
    for (const colorScheme of ["light", "dark"]) {
      const page = await open(`themes (${colorScheme})`, {colorScheme});
      if (colorScheme === "dark") await drawAllPlots(page);
      colours[colorScheme] = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      await page.evaluate(() => document.querySelector(".figure").scrollIntoView());
      await page.screenshot({path: join(shots, `${colorScheme}.png`)});
      if (colorScheme === "dark") {
        await openPackings(page);
        await page.screenshot({path: join(shots, "dark-packing.png")});
        await page.locator("#theme").selectOption("light");
        const back = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
        expect(back === colours.light, "themes: the choice is not followed");
      }
    }
    expect(colours.light !== colours.dark, `themes: both have ${colours.dark}`);
  },

  async phone() {
    const page = await open("phone", {
      viewport: {width: 375, height: 740}, deviceScaleFactor: 2, isMobile: true, hasTouch: true
    });
    await drawAllPlots(page);
    await openPackings(page);
    await page.screenshot({path: join(shots, "phone-packing.png")});
    await page.locator("details").evaluateAll((all) => all.forEach((one) => (one.open = true)));
    const {wide, culprits} = await page.evaluate(() => ({
      wide: document.documentElement.scrollWidth,
      culprits: [...document.querySelectorAll("body *")]
        .filter((element) => !element.parentElement.closest(".scroll, pre") &&
          element.getBoundingClientRect().right > 376)
        .slice(0, 5).map((element) => element.outerHTML.slice(0, 120))
    }));
    expect(wide <= 375, `phone: it is ${wide} pixels wide: ${culprits.join(" | ")}`);
    await page.locator("details").evaluateAll((all) => all.forEach((one) => (one.open = false)));
    await page.evaluate(() => document.querySelector(".figure").scrollIntoView());
    // A finger scrolls the page over a plot as elsewhere, and a tap shows values.
    const canvas = page.locator(".plot .canvas").first();
    const touches = await page.context().newCDPSession(page);
    const {x, y} = await canvas.locator(".nsewdrag").boundingBox();
    const touch = (type, ...points) => touches.send("Input.dispatchTouchEvent", {type, touchPoints: points});
    const before = await page.evaluate(() => scrollY);
    await touch("touchStart", {x: x + 60, y: y + 100});
    for (let k = 1; k <= 8; ++k) await touch("touchMove", {x: x + 60, y: y + 100 - 10 * k});
    await touch("touchEnd");
    await page.waitForTimeout(500);
    expect(await page.evaluate(() => scrollY) > before + 30, "phone: a finger does not scroll over a plot");
    const point = await canvas.locator(".point").first().boundingBox();
    await page.touchscreen.tap(point.x + point.width / 2, point.y + point.height / 2);
    let values = "";
    for (let k = 0; k < 40 && !/=/.test(values); ++k) {
      await page.waitForTimeout(500);
      values = await canvas.locator(".hoverlayer").textContent();
    }
    expect(/=/.test(values), "phone: a tap shows no values");
    await page.screenshot({path: join(shots, "phone.png")});
  }
};

const tools = {open, expect, report, shots, drawAllPlots};
Object.assign(checks, runChecks(tools), layoutChecks(tools));
const chosen = basename(report) === "many.html" ? manyChecks(tools) : checks;
for (const [name, check] of Object.entries(chosen)) {
  if (wanted.length > 0 ? !wanted.includes(name) : name === "quick") continue;
  console.log(name);
  const began = performance.now();
  try {
    await check();
  } catch (error) {
    expect(false, `${name}: ${error.message.split("\n").slice(0, 3).join(" ")}`);
  }
  console.log(`  ${((performance.now() - began) / 1000).toFixed(1)} s`);
  for (const context of browser.contexts()) await context.close();
}
await browser.close();
console.log(failures.length === 0 ? "all as it must be" : `${failures.length} not as they must be`);
process.exitCode = failures.length === 0 ? 0 : 1;
