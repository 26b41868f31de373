// SPDX-License-Identifier: GPL-3.0-or-later
// At the width of a large window and of a phone the page fits and no text is cut; in both themes text has contrast.
import {join} from "node:path";

// Elements whose text is cut or reaches beyond the page.
function misfits() {
  const what = (element) => `${element.tagName}.${element.className}: ` +
    `'${(element.textContent ?? "").trim().slice(0, 40)}'`;
  const found = [];
  const width = document.documentElement.clientWidth;
  if (document.documentElement.scrollWidth > width) {
    found.push(`the page is ${document.documentElement.scrollWidth} pixels wide`);
  }
  const texts = "td, th, label, button, h1, h2, h3, h4, p, li, dt, dd, figcaption, summary, .bar, output, a";
  for (const element of document.querySelectorAll(texts)) {
    if (element.getClientRects().length === 0 || element.matches(".visually-hidden")) continue;
    // What is inline has no width of its own.
    if (element.clientWidth > 0 && element.scrollWidth > element.clientWidth) {
      found.push(`${what(element)} is cut: ${element.scrollWidth} > ${element.clientWidth}`);
    }
    const {left, right} = element.getBoundingClientRect();
    if (right > width + 1 || left < -1) found.push(`${what(element)} leaves the page`);
  }
  for (const box of document.querySelectorAll(".scroll")) {
    if (box.scrollWidth > box.clientWidth) found.push(`${box.ariaLabel} does not fit`);
  }
  // Labels of plots stay within their picture.
  for (const text of document.querySelectorAll(".main-svg text")) {
    const outer = text.ownerSVGElement.getBoundingClientRect();
    const inner = text.getBoundingClientRect();
    if (inner.width > 0 && (inner.left < outer.left - 1 || inner.right > outer.right + 1)) {
      found.push(`'${text.textContent}' leaves its plot`);
    }
  }
  for (const bar of document.querySelectorAll(".legend .scrollbar")) {
    if (bar.getBoundingClientRect().height > 0) found.push("a legend is cut");
  }
  return found;
}

// Of a text and its background, as the Web Content Accessibility Guidelines define it.
function faintTexts() {
  const channels = (text) => text.match(/[\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map((c) => c / 255)
    .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
    .reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
  const behind = (element) => {
    const colour = channels(getComputedStyle(element).backgroundColor);
    return colour.length === 4 && colour[3] === 0 && element.parentElement
      ? behind(element.parentElement) : colour;
  };
  return [...document.querySelectorAll(".workflow li, .workflow p, .workflow h4, .workflow a, .runs td, .runs th")]
    .filter((element) => element.getClientRects().length > 0)
    .map((element) => {
      const [a, b] = [light(channels(getComputedStyle(element).color)), light(behind(element))];
      return {text: element.textContent.trim(), ratio: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05)};
    })
    .filter(({text, ratio}) => text && ratio < 4.5)
    .map(({text, ratio}) => `'${text.slice(0, 40)}' has a contrast of ${ratio.toFixed(1)}`);
}

export function layoutChecks({open, expect, shots, drawAllPlots}) {
  const checks = {};
  for (const width of [1400, 390]) {
    checks[`layout${width}`] = async () => {
      for (const colorScheme of ["dark", "light"]) {
        const page = await open(`layout${width}`, {viewport: {width, height: 900}, colorScheme});
        await page.locator(".runs .disclosure").first().click();
        const flow = page.locator(".workflow").first();
        await flow.scrollIntoViewIfNeeded();
        await page.screenshot({path: join(shots, `workflow-${width}-${colorScheme}.png`)});
        await page.locator(".runs").first().scrollIntoViewIfNeeded();
        await page.screenshot({path: join(shots, `runs-${width}-${colorScheme}.png`)});
        for (const faint of (await page.evaluate(faintTexts)).slice(0, 5)) {
          expect(false, `layout: ${colorScheme}: ${faint}`);
        }
        if (colorScheme === "dark") continue;  // its layout is the same

        const size = await flow.evaluate((one) => Math.min(...[...one.querySelectorAll("li, p, h4")]
          .map((text) => parseFloat(getComputedStyle(text).fontSize))));
        expect(size >= 12, `layout: the workflow has type of ${size} pixels at ${width}`);
        await drawAllPlots(page);
        await page.locator("#compare").scrollIntoViewIfNeeded();
        await page.locator("#compare .main-svg .xtick").first().waitFor({state: "attached"});
        const closed = await page.evaluate(misfits);
        await page.locator("details").evaluateAll((all) => all.forEach((one) => (one.open = true)));
        const opened = await page.evaluate(misfits);
        for (const misfit of [...closed, ...opened].slice(0, 8)) {
          expect(false, `layout: at ${width}: ${misfit}`);
        }
      }
    };
  }
  return checks;
}
