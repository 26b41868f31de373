// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a report with 105 runs (many.yaml): it fits a window of 1280 pixels, a phone and a sheet of A4, it begins
// with grains, its filter answers, and without scripts it says what is missing.
import {readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";

// What is wider than the page. A4 has 794 pixels, less the margins of a printer.
const tooWide = () => {
  const width = document.documentElement.clientWidth;
  const wide = [...document.querySelectorAll("table, td, th, p, figure, .plot, .box, .filter, pre, h1, h2, h3")]
    .filter((one) => one.getClientRects().length > 0 && !one.parentElement.closest("pre, .scroll") &&
      one.getBoundingClientRect().right > width + 1)
    .map((one) => `${one.tagName}.${one.className} ends at ${Math.round(one.getBoundingClientRect().right)}`);
  const page = document.documentElement.scrollWidth;
  return page > width ? [`the page has ${page} pixels`, ...wide.slice(0, 4)] : wide.slice(0, 4);
};

const openAll = (page) => page.locator("details").evaluateAll((all) => all.forEach((one) => (one.open = true)));

export function manyChecks({open, expect, report, shots, drawAllPlots}) {
  const checks = {};
  for (const width of [1280, 390]) {
    checks[`fits${width}`] = async () => {
      const page = await open(`fits${width}`, {viewport: {width, height: 900}});
      await drawAllPlots(page);
      const complain = async (state) => {
        for (const what of await page.evaluate(tooWide)) expect(false, `fits${width}: ${state}: ${what}`);
      };
      await complain("folded");
      const table = page.locator(".runs").first();
      await table.scrollIntoViewIfNeeded();
      await page.screenshot({path: join(shots, `many-${width}.png`)});
      const inside = await table.evaluate((one) => one.scrollWidth - one.clientWidth);
      expect(inside <= 0, `fits${width}: the table of runs is ${inside} pixels wider than its frame`);
      await table.getByLabel("fold by variant").uncheck();
      expect(await table.locator("tbody[data-row]").count() === 105, `fits${width}: not 105 rows`);
      await complain("unfolded");
      await openAll(page);
      await complain("with all details");
    };
  }

  return Object.assign(checks, {
    // On paper the table stays a table, and a heading stays with its plot.
    async paper() {
      const page = await open("paper", {viewport: {width: 718, height: 1040}});
      await drawAllPlots(page);
      await page.emulateMedia({media: "print"});
      await page.waitForTimeout(300);
      const found = await page.evaluate(() => {
        const style = (selector) => getComputedStyle(document.querySelector(selector));
        return {
          row: style(".runs tbody tr").display, head: style(".runs thead").display, cell: style(".runs td").display,
          overview: style(".overview tr").display, heading: style(".figure h3").breakAfter,
          section: style("section h2").breakAfter, figure: style("figure").breakInside, hidden: style("#opening").display
        };
      });
      expect(found.row === "table-row" && found.head === "table-header-group" && found.cell === "table-cell",
        `paper: the table of runs is ${found.row}, ${found.head}, ${found.cell}`);
      expect(found.overview === "table-row", `paper: the overview is ${found.overview}`);
      expect(found.heading === "avoid" && found.section === "avoid" && found.figure === "avoid",
        `paper: breaks: h3 ${found.heading}, h2 ${found.section}, figure ${found.figure}`);
      expect(found.hidden === "none", "paper: an empty 3D view");
      for (const what of await page.evaluate(tooWide)) expect(false, `paper: ${what}`);
      await page.screenshot({path: join(shots, "many-paper.png"), fullPage: true, timeout: 120_000});
      await page.pdf({path: join(shots, "many.pdf"), format: "A4", printBackground: true});
    },

    // The first screen shows the most crystalline of the final states.
    async opening() {
      const page = await open("opening");
      const canvas = page.locator("#opening canvas");
      await canvas.waitFor();
      await page.waitForTimeout(500);
      const box = await canvas.boundingBox();
      expect(box.y >= 0 && box.y + box.height <= 900 && box.width > 250, `opening: at ${JSON.stringify(box)}`);
      expect((await canvas.screenshot()).length > 20000, "opening: the picture is all but empty");
      const [most, label] = await page.evaluate(() => {
        const {packings} = JSON.parse(document.getElementById("report-data").textContent);
        const end = ({frames}) => frames.at(-1).crystalline;
        const best = packings.toSorted((a, b) => end(b) - end(a))[0];
        return [end(best), `${best.experiment}: ${best.label}`];
      });
      const facts = await page.locator('#opening [data-part="facts"]').textContent();
      expect(facts.includes(`${most.toFixed(1)} % of the interior grains crystalline`), `opening: ${facts}, not ${most}`);
      expect(await page.locator('#opening [data-part="name"]').textContent() === label, "opening: another packing is named");
      await page.screenshot({path: join(shots, "many-top.png")});
      const phone = await open("opening", {viewport: {width: 390, height: 800}});
      await phone.locator("#opening canvas").waitFor();
      const small = await phone.locator("#opening canvas").boundingBox();
      expect(small.y + small.height / 2 < 800, `opening: on a phone at ${JSON.stringify(small)}`);
    },

    async captions() {
      const page = await open("captions");
      await drawAllPlots(page);
      const figures = await page.locator(".figure:has(.plot)").evaluateAll((all) => all.map((one) =>
        ({id: one.id, caption: one.querySelector(".caption")?.textContent ?? ""})));
      for (const {id, caption} of figures) {
        expect(caption.startsWith(`Figure ${id.split(".").pop()}`) && /Experiment many\./.test(caption),
          `captions: ${id}: '${caption}'`);
      }
      const why = "Nothing is drawn in zero: no run has the values to be shown.";
      const empty = page.locator('[data-chart="many.zero"] .annotation-text');
      expect((await empty.textContent()).replace(/\s+/g, "") === why.replace(/\s+/g, ""),
        "captions: an empty plot does not say why");
      expect(figures.find(({id}) => id.endsWith("zero")).caption.includes(why), "captions: the caption does not say why");
      const nothing = await page.locator('[id="figure-many.nothing"]').textContent();
      expect(/Nothing is drawn: no run has a checkpoint at the cycles/.test(nothing), `captions: ${nothing}`);
    },

    async filter() {
      const page = await open("filter");
      const table = page.locator(".runs").first();
      await table.scrollIntoViewIfNeeded();
      await page.waitForTimeout(300);  // drawings above the table change its place
      await table.getByLabel("fold by variant").uncheck();
      const answer = async (text) => {
        await table.getByRole("searchbox").fill(text);
        const said = table.locator(".filter .warning");
        return [await table.locator("tbody[data-row]").count(), await said.isVisible() ? await said.textContent() : ""];
      };
      for (const [text, rows] of [["walls!=rough", 50], ["walls!=rough, seed=1", 10], ["seed=1,2", 42], ["walls=rough A=0.1", 5],
        ['variant="low P"', 5], ["", 105]]) {
        const [count, said] = await answer(text);
        expect(count === rows && said === "", `filter: '${text}' shows ${count} rows, not ${rows}: '${said}'`);
      }
      const [count, said] = await answer("wall=rough");
      expect(count === 105 && /There is no key 'wall'\. Did you mean walls\? Keys: .*\bpressure_Pa\b/.test(said), `filter: ${count}, '${said}'`);
    },

    // One colour for one variant: the curves of two variants side by side have the colours of their curves in the figures above.
    async colours() {
      const page = await open("colours");
      const section = page.locator("#compare");
      await section.scrollIntoViewIfNeeded();
      await section.locator(".xtick").first().waitFor({state: "attached"});
      const [names, series] = await page.evaluate(() => {
        const {charts, experiments} = JSON.parse(document.getElementById("report-data").textContent);
        return [experiments[0].runs.map(({variant}) => variant), charts["many.by_walls"].series.map(({of, colour}) => [of, colour])];
      });
      const stated = Object.fromEntries(series);
      expect(stated["walls=rough"] === "#000000" && stated["walls=smooth"] === "#d55e00", `colours: ${series}`);
      expect(new Set(names).size === 21, `colours: ${new Set(names).size} variants`);
      const above = await page.evaluate(() => JSON.parse(document.getElementById("report-data").textContent)
        .charts["many.many_phi"].series.map(({of, colour}) => [of, colour]));
      const rgb = (hex) => `rgb(${[1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)).join(", ")})`;
      const options = await section.locator("select").first().locator("option").allTextContents();
      for (const pair of ["walls=rough", "walls=smooth"]) {
        const index = options.findIndex((text) => text.includes("P=700") && text.includes(pair) && text.includes("A=0.06"));
        await section.locator(".side select").first().selectOption({index});
        await page.waitForTimeout(300);
        const colour = await section.locator(".panels .canvas").first().locator(".legendpoints path").first()
          .evaluate((mark) => mark.style.fill);
        const curve = above.find(([of]) => of.includes(pair) && of.includes("0.06") && of.includes("700"));
        expect(colour === rgb(curve[1]), `colours: ${options[index]}: ${colour} side by side, ${curve} above`);
      }
    },

    // A policy of the site that shows the page may block its script.
    async blocked() {
      const file = join(shots, "blocked.html");
      writeFileSync(file, readFileSync(report, "utf8").replace(/script-src 'sha256-[^']*'/, "script-src 'none'"));
      const page = await open("blocked", {file, mayFail: true});
      const sentences = page.locator(".unscripted");
      const plots = await page.locator("[data-chart]").count();
      expect(plots > 2 && await sentences.count() === plots + 1, `blocked: ${await sentences.count()} sentences for ${plots} plots`);
      expect(await sentences.first().isVisible() && /need JavaScript, which has not run/.test(await sentences.first().textContent()),
        "blocked: the page does not say that its script has not run");
      await page.screenshot({path: join(shots, "many-blocked.png")});
      const whole = await open("blocked");
      expect(await whole.locator(".unscripted").count() === 0, "blocked: the sentence stays where scripts run");
    }
  });
}
