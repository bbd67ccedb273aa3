// SPDX-License-Identifier: Apache-2.0
// node node.cjs FOLDER WORKER_JS HASHES PAGE: the core as WebAssembly, from the folder where it was built, draws the views of the page's
// list with the hashes of the desktop program, at once and in parts; what is wrong is refused in words. The page has that core.
"use strict";
const assert = require("node:assert");
const fs = require("node:fs");
const path = require("node:path");

async function main() {
  const [folder, worker, hashes, page] = process.argv.slice(2).map((p) => path.resolve(p));
  const { Core, rowsOf } = require(worker);
  const { unpackLzma } = require(path.join(path.dirname(worker), "lzma.js"));
  const wasm = fs.readFileSync(path.join(folder, "anamorph.wasm"));
  const [, bytes, text] = /<script id="wasm"[^>]* data-bytes="(\d+)">([^<]*)</.exec(fs.readFileSync(page, "utf8"));
  const packed = Buffer.from(text, "base64");
  assert(wasm.equals(unpackLzma(packed, Number(bytes))), "the page has another core");
  assert.throws(() => unpackLzma(packed.subarray(0, packed.length / 2), Number(bytes)), /ends too soon|damaged/);
  const core = new Core(await require(path.join(folder, "anamorph.js"))({ wasmBinary: wasm }));

  const { projections, operations } = core.ask("describe");
  assert(projections.length >= 20 && operations.pano.keys.tol.default === "0.01");
  assert.throws(() => core.plan("pano?to=fisheye"), /no image/);
  let started = performance.now();
  assert.deepStrictEqual(core.sample(2048), { width: 4096, height: 2048 });
  console.log(`the panorama: ${Math.round(performance.now() - started)} ms`);

  let wrong = 0, count = 0;
  for (const line of fs.readFileSync(hashes, "utf8").split("\n")) {
    const [, hash, recipe] = /^([0-9a-f]{32}) (\S+)/.exec(line) || [];
    if (!hash) continue;
    started = performance.now();
    const plan = core.plan(recipe), planned = performance.now();
    const rgba = core.draw(0, plan.height), drawn = performance.now();
    const parts = [0, 1, 2].map((i) => core.draw(...rowsOf(plan.height, i, 3)));
    assert.deepStrictEqual(Buffer.concat(parts).compare(rgba), 0, `${recipe} in parts`);
    const found = core.hash(rgba), error = plan.says["anamorph:max_error"], tol = plan.says["anamorph:tol"];
    assert(error <= tol || (tol === 0 && error < 1e-6), `${recipe}: an error of ${error}`);
    const ns = (1e6 * (drawn - planned)) / (plan.width * plan.height);
    console.log(`${found === hash ? "same " : "OTHER"} ${found} ${recipe}: plan ${(planned - started).toFixed(1)} ms, ${(drawn - planned).toFixed(1)} ms, ${ns.toFixed(1)} ns/px`);
    wrong += found !== hash;
    ++count;
  }
  assert(count >= 10, "the list is too short");

  const mesh = (direction) => JSON.stringify({ columns: 1, rows: 1, units: "fractions", direction, vertices: [[0, 0], [1, 0], [0, 1], [1, 1]] });
  core.file("pulls.json", mesh("pull"));
  core.file("pushes.json", mesh("push"));
  core.file("points.csv", "0,0,1,1\n");
  for (const [recipe, message] of [
    ["pano?to=flat", /to=flat: must be one of/],
    ["pano?fov=0", /fov=0/],
    ["pano?fov=nan", /fov=nan/],
    ["pano?size=99999999x4", /size/],
    ["map?u=x+", /u/],
    ["lens?lens=ptlens:q=1", /q/],
    ["warp?mesh=none.json", /none\.json/],
    ["warp?mesh=map.exr", /map\.exr/],
    ["figure?script=a.nudes", /figure/],
    ["nothing", /nothing/],
    ["", /recipe/],
    ["pano?alpha=1", /alpha/],
    ["pano?scheme=hardware", /scheme=hardware is not in this build/],
    ["pano?scheme=residual", /scheme=residual is not in this build/],
    ["pano?to=formula&ray_x=1&ray_y=0&ray_z=0&size=64x64", /to=formula is not in this build/],
    ["pano?stereo=top-bottom", /stereo=top-bottom is not in this build/],
    ["pano?shutter=1", /a film is not in this build/],
    ["lens?lens=ptlens:b=-0.1&scheme=residual", /scheme=residual is not in this build/],
    ["map?u=x&v=y&direction=push", /direction=push is not in this build/],
    ["warp?points=points.csv", /points=points\.csv is not in this build/],
    ["warp?mesh=pulls.json", /pulls\.json.*, a mesh that pulls, is not in this build/],
    ["warp?mesh=pushes.json&output=mesh", /output=mesh is not in this build/],
    ["pano?lens=lensfun:lens=x", /lens/],
  ])
    assert.throws(() => core.plan(recipe), message, recipe);
  assert.throws(() => core.sample(1000), /height=1000: must be/);
  for (const recipe of ["pano?to=fisheye&size=64x64", "warp?mesh=pushes.json&size=64x64"])
    assert(core.plan(recipe).width === 64 && core.draw(0, 1).length, `${recipe} after that`);
  if (wrong) throw new Error(`${wrong} of ${count} views have another hash than the desktop program's`);
  console.log(`${count} views have the hashes of the desktop program`);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
