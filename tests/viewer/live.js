// What a browser shows of the live page at an address. In, as JSON: {"url": address}. Out, as JSON: "shots", three looks at the
// scene, two while the light grows and one after Stop, each with its round, its exposure, the size of the canvas and a picture
// (PNG, base64); "views", a picture of each view; "outside", the requests that went anywhere else; "problems", what the
// console complained of; "phase", what the page says in the end.

import { text } from "node:stream/consumers";
import { inBrowser } from "./browser.js";

// The scene as it is now, with an exposure that stays while it is looked at.
async function look(page) {
  await page.setChecked("#hold", true);
  // Until what is shown was drawn with it.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const canvas = page.locator("#scene");
  const { round, exposure } = await canvas.evaluate((element) => ({ ...element.dataset }));
  const { width, height } = await canvas.boundingBox();
  const picture = (await canvas.screenshot()).toString("base64");
  await page.setChecked("#hold", false);
  return { round: Number(round), exposure: Number(exposure), width, height, picture };
}

const roundIsPast = (least) => Number(document.querySelector("#scene").dataset.round) > least;

async function run({ url }) {
  return inBrowser(async (browser) => {
    const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
    const [outside, problems, shots, views] = [[], [], [], {}];
    page.on("request", (request) => {
      const asked = new URL(request.url());
      if (asked.protocol !== "data:" && asked.origin !== new URL(url).origin) outside.push(asked.href);
    });
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type())) problems.push(message.text());
    });
    page.on("pageerror", (error) => problems.push(error.message));
    await page.goto(url);
    await page.waitForFunction(roundIsPast, 0);
    shots.push(await look(page));
    await page.waitForTimeout(2000);
    await page.waitForFunction(roundIsPast, shots[0].round);
    shots.push(await look(page));
    for (const view of ["irradiance", "elements", "parts", "row-sums", "computed", "radiosity"]) {
      // As with the keyboard: the inputs themselves are not to be seen.
      await page.focus(`input[value=${view}]`);
      await page.keyboard.press("Space");
      await page.waitForTimeout(400);
      views[view] = (await page.locator("#scene").screenshot()).toString("base64");
    }
    await page.click("#stop");
    await page.waitForSelector("#close", { state: "visible" });
    // The last light may still be on its way.
    await page.waitForTimeout(1000);
    shots.push(await look(page));
    const phase = await page.textContent("#phase");
    return { shots, views, outside, problems, phase };
  });
}

console.log(JSON.stringify(await run(JSON.parse(await text(process.stdin)))));
