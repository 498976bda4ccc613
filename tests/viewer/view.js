// What three.js shows of a model at points of its surfaces. In, as JSON: {"file": path, "points": [{"point": [x, y, z],
// "normal": [x, y, z]}]}. Out, as JSON: "pixels", linear RGB for each point, and "outside", the requests that the page made
// beyond its own files. There is no light but what the model emits.

import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { text } from "node:stream/consumers";
import { inBrowser } from "./browser.js";

// A made-up place that only the handler below answers for.
const ORIGIN = "http://viewer.invalid";

const PAGE = `<script type="importmap">{ "imports": { "three": "${ORIGIN}/three/build/three.module.js" } }</script>`;

// Runs in the page: a look at each point from close before it, one pixel each.
async function look({ origin, points }) {
  const three = await import("three");
  const { GLTFLoader } = await import(`${origin}/three/examples/jsm/loaders/GLTFLoader.js`);
  const scene = (await new GLTFLoader().loadAsync(`${origin}/model.glb`)).scene;
  const renderer = new three.WebGLRenderer();
  const target = new three.WebGLRenderTarget(1, 1, { type: three.FloatType });
  const distance = 1e-3;
  const camera = new three.OrthographicCamera(-1e-5, 1e-5, 1e-5, -1e-5, 0, 2 * distance);
  return points.map(({ point, normal }) => {
    const [at, away] = [new three.Vector3(...point), new three.Vector3(...normal)];
    camera.position.copy(at).addScaledVector(away, distance);
    camera.up.set(0, 1, 0);
    if (Math.abs(away.y) > 0.9) camera.up.set(1, 0, 0);
    camera.lookAt(at);
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    const pixel = new Float32Array(4);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, pixel);
    return Array.from(pixel.slice(0, 3));
  });
}

async function run({ file, points }) {
  return inBrowser(async (browser) => {
    const page = await browser.newPage();
    const outside = [];
    await page.route("**/*", async (route) => {
      const url = new URL(route.request().url());
      if (url.protocol === "blob:") return route.continue();
      if (url.origin !== ORIGIN) {
        outside.push(url.href);
        return route.abort();
      }
      const headers = { "access-control-allow-origin": "*" };
      if (url.pathname === "/") return route.fulfill({ contentType: "text/html", body: PAGE });
      if (url.pathname === "/model.glb") {
        return route.fulfill({ headers, contentType: "model/gltf-binary", body: await readFile(file) });
      }
      const path = fileURLToPath(new URL(`node_modules${url.pathname}`, import.meta.url));
      return route.fulfill({ headers, contentType: "text/javascript", body: await readFile(path) });
    });
    await page.goto(`${ORIGIN}/`);
    return { pixels: await page.evaluate(look, { origin: ORIGIN, points }), outside };
  });
}

console.log(JSON.stringify(await run(JSON.parse(await text(process.stdin)))));
