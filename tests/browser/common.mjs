// Pages in Chromium: opened from file://, with what their consoles say against them.
import { after, before } from "node:test";
import assert from "node:assert/strict";
import { join } from "node:path";
import { chromium } from "playwright-core";

export const { PAGES, PICTURES, PROGRAM } = process.env;
let browser;
before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
    args: ["--no-sandbox", "--enable-unsafe-swiftshader"],
  });
});
after(() => browser.close());

/** A page from file://; what its console says against it is found in `complaints`, and what it loads beside itself. */
export async function open(path, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, ...options });
  page.setDefaultTimeout(180_000);
  page.complaints = [];
  page.on("console", (message) => message.type() === "error" && page.complaints.push(message.text()));
  page.on("pageerror", (error) => page.complaints.push(error.message));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) page.complaints.push(`asks the network: ${request.url()}`);
  });
  await page.goto(`file://${path}`);
  await page.waitForSelector("html[data-ready]", { state: "attached" });
  return page;
}
export const of = (name) => join(PAGES, name, "report.html");
export const made = (name) => join(PAGES, `${name}.html`);

export async function close(page, picture) {
  if (PICTURES && picture) {
    await page.waitForTimeout(400);
    await page.screenshot({ path: join(PICTURES, `${picture}.png`), fullPage: true });
  }
  assert.deepEqual(page.complaints, []);
  await page.close();
}

export const text = (page, selector) => page.locator(selector).innerText();
export const picture = (page, selector) => page.locator(selector).evaluate((canvas) => canvas.toDataURL());

