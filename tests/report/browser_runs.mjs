// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of the tables of runs, of two variants side by side, and of the workflow.
import {join} from "node:path";
import {chartsOfVariants, variantLooks} from "../../experiments/report/web/src/charts.js";
import {readFilter} from "../../experiments/report/web/src/filter.js";

// The first table with more than one run, as the page shows it.
async function openTable(page) {
  const name = await page.locator("[data-runs]").evaluateAll((hosts) =>
    hosts.find((host) => host.querySelectorAll("tbody").length > 3).dataset.runs);
  const table = page.locator(`[data-runs="${name}"]`);
  await table.scrollIntoViewIfNeeded();
  const column = async (key) => table.evaluate((host, wanted) => {
    const at = [...host.querySelectorAll("th")].findIndex((head) => head.dataset.key === wanted);
    return [...host.querySelectorAll("tbody:not([hidden])")]
      .map((body) => body.rows[0].cells[at].dataset.value);
  }, key);
  return {table, column};
}

export function runChecks({open, expect, shots}) {
  return {
    async sorting() {
      const page = await open("sorting");
      const {table, column} = await openTable(page);
      const declared = await column("run");
      const head = table.locator('th[data-key="phi"]');
      await head.getByRole("button").click();
      const up = (await column("phi")).map(Number);
      expect(up.length > 1 && up.every((phi, k) => k === 0 || phi >= up[k - 1]),
        `sorting: phi ascending: ${up}`);
      expect(await head.getAttribute("aria-sort") === "ascending", "sorting: no aria-sort");
      await head.getByRole("button").press("Enter");
      const down = (await column("phi")).map(Number);
      expect(down.join() === [...up].reverse().join(), `sorting: phi descending: ${down}`);
      await table.locator('th[data-key="state"]').getByRole("button").click();
      expect(await head.getAttribute("aria-sort") === null, "sorting: by two columns at once");
      expect([...await column("run")].sort().join() === [...declared].sort().join(),
        "sorting: rows were lost");
    },

    async filtering() {
      const page = await open("filtering");
      const {table, column} = await openTable(page);
      const all = await column("phi");
      const limit = [...all].map(Number).sort((a, b) => a - b)[Math.floor(all.length / 2)];
      const input = table.getByRole("searchbox");
      const shown = async (text) => {
        await input.fill(text);
        return column("phi");
      };
      const above = await shown(`phi>${limit}`);
      expect(above.length > 0 && above.length < all.length && above.every((phi) => phi > limit),
        `filtering: phi>${limit}: ${above}`);
      expect(await table.locator("output").textContent() === `${above.length} of ${all.length} runs`,
        "filtering: the count is another");
      const [run] = await column("run");
      expect((await shown(run.slice(0, 8))).length === 1, "filtering: a text of one row");
      expect((await shown(`seed=1 phi<=${limit}`)).length > 0, "filtering: two conditions");
      expect((await column("seed")).every((seed) => seed === "1"), "filtering: another seed");
      expect((await shown("nothing like it")).length === 0, "filtering: a text of no row");
      expect((await shown("seed")).length === 0, "filtering: a word of a heading");
      expect((await shown("")).length === all.length, "filtering: an empty filter hides rows");
    },

    // As the page writes a parameter: by its symbol.
    async symbols() {
      const page = await open("symbols");
      const table = page.locator('[data-runs]:has(th[data-key="amplitude_rad"])').first();
      const value = await table.locator("tbody[data-row]").first().evaluate((body) =>
        body.rows[0].cells[body.closest("table").querySelector('th[data-key="amplitude_rad"]').cellIndex].dataset.value);
      const all = await table.locator("tbody[data-row]").count();
      const counted = async (text) => {
        await table.getByRole("searchbox").fill(text);
        return table.locator("tbody[data-row]").count();
      };
      const by = await counted(`amplitude_rad=${value}`);
      expect(by > 0 && by < all, `symbols: amplitude_rad=${value} finds ${by} of ${all} runs`);
      expect(await counted(`A=${value}`) === by, `symbols: A=${value} finds others`);
    },

    async folding() {
      const page = await open("folding");
      const {table, column} = await openTable(page);
      const rows = (await column("run")).length;
      await table.getByLabel("fold by variant").check();
      const variants = table.locator("tbody.variant");
      const names = await variants.evaluateAll((all) => all.map((body) => body.rows[0].cells[0].textContent));
      expect(names.length > 1 && await table.locator("tbody[data-row]").count() === 0, `folding: ${names}`);
      const counts = names.map((name) => Number(name.match(/\((\d+) runs?\)$/)[1]));
      expect(counts.reduce((sum, count) => sum + count, 0) === rows, `folding: ${counts} of ${rows} runs`);
      await variants.first().locator(".disclosure").press("Enter");
      expect(await table.locator("tbody[data-row]").count() === counts[0], "folding: a variant does not open");
      const at = await table.locator('th[data-key="phi"]').evaluate((head) => head.cellIndex);
      const mean = Number(await variants.first().locator("td").nth(at).evaluate((cell) => cell.lastChild.textContent));
      const phi = (await table.locator("tbody[data-row]").evaluateAll((all, k) =>
        all.map((body) => Number(body.rows[0].cells[k].dataset.value)), at));
      expect(Math.abs(mean - phi.reduce((sum, one) => sum + one, 0) / phi.length) < 1e-4, `folding: ${mean} of ${phi}`);
      await table.getByLabel("fold by variant").uncheck();
      expect((await column("run")).length === rows, "folding: rows were lost");
    },

    async columns() {
      const page = await open("columns");
      const {table} = await openTable(page);
      await table.getByText("Columns", {exact: true}).click();
      const key = "contacts_per_grain";
      const box = table.locator("details").first().getByLabel(key, {exact: true});
      await box.check();
      const head = table.locator(`th[data-key="${key}"]`);
      const at = await head.evaluate((one) => one.cellIndex);
      const values = await table.locator("tbody[data-row]").evaluateAll((all, k) =>
        all.map((body) => body.rows[0].cells[k].lastChild.textContent), at);
      expect(values.length > 3 && values.some((text) => text !== "–"), `columns: ${key}: ${values}`);
      await head.getByRole("button").click();
      expect(await head.getAttribute("aria-sort") === "ascending", `columns: ${key} does not sort`);
      await box.uncheck();
      expect(!(await head.isVisible()), `columns: ${key} stays`);
    },

    async measures() {
      const page = await open("measures");
      const {table} = await openTable(page);
      await table.getByText("Plot measures").click();
      const plot = table.locator("details .plot");
      await plot.locator(".xtick").first().waitFor({state: "attached"});
      const shown = async () => [await plot.locator(".xtitle, .ytitle").allTextContents(),
        await plot.locator(".point").count()];
      const [[x, y], points] = await shown();
      expect(x === "shear cycle n" && y === "volume fraction ϕ" && points > 5, `measures: ${x}, ${y}, ${points}`);
      await table.locator(".choices select").first().selectOption("largest_overlap_d");
      await table.locator(".choices select").nth(1).selectOption("phi");
      await page.waitForTimeout(500);
      const [[phi, other], ends] = await shown();
      expect(phi === "volume fraction ϕ" && /largest overlap/.test(other) &&
        ends === await table.locator("tbody[data-row]").count(), `measures: ${phi}, ${other}, ${ends} points`);
      await plot.screenshot({path: join(shots, "measures.png")});
    },

    async traces() {
      const page = await open("traces");
      const {table} = await openTable(page);
      const body = table.locator("tbody").nth(1);
      await body.locator('td:has(.state)').click();
      const plots = body.locator(".trace .canvas");
      await plots.nth(1).locator(".xtick").first().waitFor({state: "attached"});
      expect(await plots.count() === 2, "traces: not two plots");
      const labels = await body.locator(".trace").locator(".xtitle, .ytitle").allTextContents();
      for (const label of ["volume fraction ϕ", "percentage crystalline  [%]", "shear cycle n"]) {
        expect(labels.includes(label), `traces: labels ${labels}`);
      }
      expect(await body.locator(".trace .point").count() > 3, "traces: no points");
      await body.scrollIntoViewIfNeeded();
      await page.screenshot({path: join(shots, "trace.png")});
      await table.locator('th[data-key="phi"]').getByRole("button").click();
      const following = await table.locator("tr.trace").evaluate((line) =>
        line.parentElement.classList.contains("open") && line.previousElementSibling !== null);
      expect(following, "traces: it does not follow its row when rows are sorted");
      const opener = table.locator("tbody.open .disclosure");
      await opener.focus();
      await page.keyboard.press("Enter");
      expect(await table.locator("tr.trace").count() === 0, "traces: Enter does not close it");
      await page.keyboard.press("Enter");
      expect(await table.locator("tr.trace").count() === 1, "traces: Enter does not open it");
      await table.locator(".trace button").first().focus();
      await page.keyboard.press("Escape");
      expect(await table.locator("tr.trace").count() === 0, "traces: Escape does not close it");
      expect(await page.evaluate(() => document.activeElement.className === "disclosure"),
        "traces: the focus is lost");
    },

    async compare() {
      const page = await open("compare", {viewport: {width: 1400, height: 900}});
      const section = page.locator("#compare");
      await section.scrollIntoViewIfNeeded();
      await section.locator(".xtick").first().waitFor({state: "attached"});
      expect(await section.locator(".panels .canvas").count() === 2, "compare: not two plots");
      for (const plot of [0, 1]) {
        const names = await section.locator(".panels .canvas").nth(plot).locator(".legendtext").allTextContents();
        expect(["first", "second"].every((side) => names.filter((name) => name.startsWith(`${side}, seed`)).length > 1),
          `compare: plot ${plot} has the curves ${names}`);
      }
      const looks = await section.locator(".panels .canvas").first().locator(".legendpoints path").evaluateAll((all) =>
        all.map((mark) => mark.style.fill + mark.style.stroke + mark.getAttribute("d")));
      expect(new Set(looks).size === looks.length, `compare: two curves look alike: ${looks}`);
      await section.locator(".comparison > div").last().scrollIntoViewIfNeeded();
      await section.locator(".pane canvas").nth(1).waitFor();
      await page.waitForTimeout(300);
      const pictures = section.locator(".pane canvas");
      const before = await pictures.nth(1).screenshot();
      await pictures.nth(0).focus();
      await page.keyboard.press("ArrowLeft");
      await page.keyboard.press("ArrowLeft");
      await page.waitForTimeout(250);
      const turned = await pictures.nth(1).screenshot();
      expect(!before.equals(turned), "compare: the other packing does not turn");
      await section.locator('[data-part="colour"]').selectOption("q6");
      await page.waitForTimeout(250);
      expect(!turned.equals(await pictures.nth(1).screenshot()), "compare: one is not coloured");
      await section.screenshot({path: join(shots, "compare.png")});
      const side = section.locator(".side").nth(0);
      const facts = await side.locator(".small").textContent();
      await side.locator("select").selectOption({index: 2});
      expect(await side.locator(".small").textContent() !== facts, "compare: the choice is not followed");
    },

    // Of a variant with many seeds.
    async styles() {
      const runs = Array.from({length: 20}, (_, k) => ({variant: "still", seed: k + 1, cycle: [0], phi: [0.6],
        crystalline_percent: [0]}));
      const {series} = chartsOfVariants([{runs, colour: "#0072b2"}, {runs, colour: "#d55e00"}])[0].chart;
      const looks = new Set(series.map(({colour, point, dashed}) => `${colour} ${point} ${dashed}`));
      expect(looks.size === 40, `styles: ${looks.size} of 40 curves`);
      const few = runs.slice(0, 6);
      const alike = chartsOfVariants([{runs: few, colour: "#000000"}, {runs: few, colour: "#000000"}])[0].chart.series;
      expect(new Set(alike.map(({point, dashed}) => `${point} ${dashed}`)).size === 12, "styles: one colour, equal markers");
    },

    // A variant has the colour of its curve, however the curve states its values; others get colours that are free.
    async variants() {
      const columns = [{key: "walls"}, {key: "pressure_Pa"}];
      const rows = [["rough", 700], ["smooth", 700], ["smooth", 954], [null, 1e3]];
      const runs = rows.map(([walls, pressure]) => ({variant: `${walls} ${pressure}`}));
      const charts = [{series: [{of: "all", colour: "#111111"}, {of: "walls=rough", colour: "#000000"},
        {of: "pressure_Pa=954.0;walls=smooth", colour: "#0072b2"}, {colour: "#222222"}]}];
      const lookOf = variantLooks({columns, rows, runs}, charts);
      const colours = runs.map((run) => lookOf(run).colour);
      expect(colours[0] === "#000000" && colours[2] === "#0072b2", `variants: ${colours}`);
      expect(new Set(colours).size === 4, `variants: ${colours}`);
    },

    // Each line: a filter, the rows that pass, and what the page says of it.
    async filters() {
      const columns = [
        {key: "seed", symbol: "", values: [1, 2, 3]}, {key: "phi", symbol: "ϕ", values: [0.61, 0.64321, null]},
        {key: "walls", symbol: "", values: ["rough", "smooth", "rough"]},
        {key: "variant", symbol: "", values: ["low P", "P=954 Pa, walls=smooth", "x"]}
      ];
      const words = ["aa low p rough", "bb smooth", "cc rough"];
      const keys = /Keys: seed, phi, walls, variant\./;
      for (const [text, rows, problem] of [
        ["", "0,1,2"], [",", "0,1,2"], ["walls!=rough", "1"], ["walls≠rough", "1"], ["seed=1,3", "0,2"], ["seed=1, 3", "0,2"],
        ["seed!=1,3", "1"], ["walls=rough,phi>0.6", "0"], ["walls = rough, phi > 0.6", "0"], ["walls=rough phi>0.6", "0"],
        ["phi=0.6432", "1"], ["PHI>=0.62", "1"], ["ϕ≥0.62", "1"], ["seed==2", "1"], ["seed<>2", "0,2"], ['variant="low P"', "0"],
        ['variant="P=954 Pa, walls=smooth"', "1"], ["aa,bb", "0,1"], ["phi!=0.61", "1,2"],
        ["phii>0.6", "0,1,2", /There is no key 'phii'\. Did you mean phi\?/], ["phii>0.6 seed=1", "0", keys],
        ["wals=rough", "0,1,2", /Did you mean walls\?/], ["zzzzzz=1", "0,1,2", keys],
        ["phi>abc", "0,1,2", /phi is a number, but 'abc' is not a number/], ["phi=", "0,1,2", /lacks a value/],
        ["walls<rough", "0,1,2", /walls is a text: compare it with = or !=/], ["phi>0.6,0.7", "0,1,2", /takes one number/],
        ["seed=99", "", /No run has seed = 99\. The values are 1, 2, 3\./], ["seed=1,99", "0", /No run has seed = 99/],
        ["variant=low P", "", /No run has variant = low\. .* Write a value with blanks in quotes: variant="low P"\./],
        ["nothing", "", /No run has the text 'nothing'/], ["nothing", "", keys], ["!=", "", keys], ['seed="1', "0"]
      ]) {
        const {passes, problems} = readFilter(text, columns, words);
        const found = [0, 1, 2].filter(passes).join();
        expect(found === rows, `filters: '${text}' passes ${found}, not ${rows}`);
        const said = problems.join(" ");
        expect(problem ? problem.test(said) : said === "", `filters: '${text}' says '${said}'`);
      }
    },

    async workflow() {
      const page = await open("workflow");
      const flows = await page.locator(".workflow").evaluateAll((all) => all.map((flow) =>
        [...flow.querySelectorAll(".box")].map((box) => box.innerText.replace(/\s+/g, " "))));
      expect(flows.length > 5, `workflow: ${flows.length}`);
      for (const boxes of flows) {
        expect(boxes.map((text) => text.split(" ")[0]).join() ===
          "Manifest,Packings,Runs,Checkpoints,Figures", `workflow: ${boxes}`);
        expect(/\d+ done/.test(boxes[2]) && /\d+ stored/.test(boxes[3]), `workflow: ${boxes}`);
      }
      const counted = await page.locator("section.experiment").first().evaluate((section) => ({
        rows: section.querySelectorAll("[data-runs] tbody").length,
        done: parseInt(section.querySelector(".workflow .box:nth-child(3) li").innerText.match(/\d+/)[0], 10)
      }));
      expect(counted.rows === counted.done, `workflow: ${counted.done} runs of ${counted.rows}`);
    }
  };
}
