// A page in Chromium, in real time: workers do not run in virtual time.

import { spawn } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";

/** Opens a file, runs an asynchronous function of the page's own there, and returns what it returns. Pictures go to `picture`. */
export async function inChromium(browser, file, run, { link = "", size = [1200, 800], picture } = {}) {
  const profile = fs.mkdtempSync(path.join(os.tmpdir(), "page-"));
  const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  const child = spawn(browser, [...flags, "--remote-debugging-pipe", `--user-data-dir=${profile}`, `--window-size=${size}`, "about:blank"], {
    stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
  });
  const [, , , to, from] = child.stdio;
  let [last, rest] = [0, ""];
  const waiting = new Map();
  const heard = [];
  from.on("data", (data) => {
    const messages = (rest + data).split("\0");
    rest = messages.pop();
    for (const { id, error, result, method, params } of messages.map((text) => JSON.parse(text))) {
      if (id === undefined) heard.push({ method, params });
      else if (error) waiting.get(id)?.reject(new Error(error.message));
      else waiting.get(id)?.resolve(result);
    }
  });
  const call = (method, params = {}, sessionId) =>
    new Promise((resolve, reject) => {
      waiting.set(++last, { resolve, reject });
      to.write(`${JSON.stringify({ id: last, method, params, sessionId })}\0`);
    });
  try {
    const { targetId } = await call("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await call("Target.attachToTarget", { targetId, flatten: true });
    const page = (method, params) => call(method, params, sessionId);
    await page("Page.enable");
    await page("Runtime.enable");
    await page("Network.enable");
    await page("Page.navigate", { url: `file://${file}${link}` });
    while (!heard.some(({ method }) => method === "Page.loadEventFired")) await new Promise((done) => setTimeout(done, 20));
    const { result, exceptionDetails } = await page("Runtime.evaluate", { expression: `(${run})()`, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    if (picture) fs.writeFileSync(picture, Buffer.from((await page("Page.captureScreenshot")).data, "base64"));
    const asked = heard.filter(({ method }) => method === "Network.requestWillBeSent").map(({ params }) => params.request.url);
    const thrown = heard.filter(({ method }) => method === "Runtime.exceptionThrown").map(({ params }) => params.exceptionDetails.text);
    return { value: result.value, asked: asked.filter((url) => /^(https?|ws)/.test(url)), thrown };
  } finally {
    const ended = new Promise((done) => child.once("exit", done));
    child.kill("SIGKILL");
    await ended;
    fs.rmSync(profile, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
  }
}
