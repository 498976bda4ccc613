// A browser without a window, and what it is given to do. Whoever has none is told so: {"skipped": why}.

import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const BROWSERS = ["/usr/bin/chromium", "/usr/bin/chromium-headless-shell", "/usr/bin/google-chrome"];

export async function inBrowser(work) {
  const executablePath = BROWSERS.find(existsSync);
  if (!executablePath) return { skipped: `there is no browser at ${BROWSERS.join(", ")}` };
  const browser = await chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
  try {
    return await work(browser);
  } finally {
    await browser.close();
  }
}
