// SPDX-License-Identifier: Apache-2.0
"use strict";

const $ = (id) => document.getElementById(id);
const round = (x, digits) => Number(x.toFixed(digits));
const clamp = (x, least, most) => Math.min(most, Math.max(least, x));

// ---- Workers: each has the whole image and draws its rows of every picture ----

class Workers {
  static async start(count) {
    const packed = Uint8Array.from(atob($("wasm").textContent.trim()), (c) => c.charCodeAt(0));
    const wasm = await WebAssembly.compile(unpackLzma(packed, Number($("wasm").dataset.bytes)));
    const url = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));
    const workers = new Workers();
    workers.all = Array.from({ length: count }, () => new Worker(url));
    workers.waiting = new Map();
    workers.last = 0;
    for (const worker of workers.all) {
      worker.onmessage = ({ data }) => {
        const { resolve, reject } = workers.waiting.get(data.id);
        workers.waiting.delete(data.id);
        if (data.error !== undefined) reject(new Error(data.error));
        else resolve(data.answer);
      };
      worker.onerror = (event) => report(new Error(event.message || "a worker ended"));
    }
    await workers.askAll({ ask: "start", wasm });
    return workers;
  }

  ask(i, message) {
    return new Promise((resolve, reject) => {
      const id = ++this.last;
      this.waiting.set(id, { resolve, reject });
      this.all[i].postMessage({ ...message, id });
    });
  }
  /// All are waited for, also where one fails.
  async askAll(message) {
    const answers = await Promise.allSettled(this.all.map((_, i) => this.ask(i, { ...message, part: i, parts: this.all.length })));
    const failed = answers.find((a) => a.status === "rejected");
    if (failed) throw failed.reason;
    return answers.map((a) => a.value);
  }
}

let workers = null;
const state = {
  source: null, // name, width, height, file: the name in recipes, isSample: is it the panorama of which hashes are listed?
  mesh: null, // sixteen points, in parts of the picture
  projections: new Map(),
  shown: null, // what is drawn: recipe, rgba, width, height
  busy: false,
  wanted: false,
  moving: false,
};

// ---- The recipe, as the settings say it ----

const number = (id) => round(Number($(id).value), 4);
const mode = () => document.querySelector("input[name=mode]:checked").value;

function paramsOf(sizeText, tol) {
  const list = [];
  const add = (key, value, unless) => {
    if (String(value) !== String(unless)) list.push(`${key}=${value}`);
  };
  switch (mode()) {
    case "pano": {
      const to = $("to").value;
      if ($("from").value) add("from", $("from").value);
      if (!$("srcfov-row").hidden && $("srcfov").value) add("srcfov", number("srcfov"));
      add("to", to);
      if (!state.projections.get(to).fixed) add("fov", number("fov"));
      if (!$("d-row").hidden) add("d", number("d"), 1);
      add("yaw", number("yaw"), 0);
      add("pitch", number("pitch"), 0);
      add("roll", number("roll"), 0);
      add("lens", $("view-lens").value.trim() || "none", "none");
      break;
    }
    case "lens":
      add("lens", $("lens").value.trim());
      add("fov", number("lens-fov"));
      add("mode", $("lens-mode").value, "undistort");
      break;
    case "warp":
      add("mesh", "mesh.json");
      add("amount", number("amount"), 1);
      break;
    case "map":
      for (const key of ["let", "u", "v"]) {
        const text = $(key).value.replace(/\s+/g, "");
        if (text) add(key, text);
      }
      break;
  }
  add("size", sizeText);
  add("filter", $("filter").value, "antialias");
  add("tol", tol);
  return list.join("&");
}
const recipe = () => `${mode()}?${paramsOf($("size").value, $("tol").value)}`;

/// The recipe that is drawn while something moves.
function movingRecipe() {
  if (!$("coarse").checked) return recipe();
  const [w, h] = $("size").value.split("x").map(Number);
  return `${mode()}?${paramsOf(`${w / 2}x${h / 2}`, Math.max(1, $("tol").value))}`;
}

function meshText() {
  return JSON.stringify({ columns: 3, rows: 3, units: "fractions", direction: "push", vertices: state.mesh });
}

// ---- Drawing ----

/// Draws what is wanted, one picture after the other; what came in between is left out.
async function draw() {
  state.wanted = true;
  if (state.busy || !state.source) return;
  state.busy = true;
  const next = () => {
    if (!state.wanted) return null;
    state.wanted = false;
    return askFor(state.moving ? movingRecipe() : recipe());
  };
  try {
    for (let asked = next(); asked; asked = asked || next()) {
      const view = await asked;
      asked = next(); // is drawn while this one is shown
      show(view);
      await new Promise((done) => requestAnimationFrame(done));
    }
  } finally {
    state.busy = false;
  }
  if (!state.moving && state.shown && !state.source.isPreview) settle();
}

/// What the workers draw of a recipe, or why they do not.
async function askFor(recipe) {
  const started = performance.now();
  try {
    return { recipe, parts: await workers.askAll({ ask: "view", recipe }), took: performance.now() - started };
  } catch (error) {
    return { error };
  }
}

function show({ recipe, parts, took, error }) {
  if (error) return report(error);
  const { width, height, says } = parts[0], view = $("view");
  if (view.width !== width || view.height !== height) Object.assign(view, { width, height });
  const rgba = new Uint8ClampedArray(4 * width * height);
  for (const part of parts) rgba.set(part.pixels, 4 * width * part.y0);
  view.getContext("2d", { alpha: false }).putImageData(new ImageData(rgba, width, height), 0, 0);
  state.shown = { recipe, rgba, width, height, says, took, planning: Math.max(...parts.map((p) => p.planning)) };
  $("problem").hidden = true;
  showFacts();
}

function report(error) {
  $("problem").textContent = error.message;
  $("problem").hidden = false;
  state.shown = null;
  for (const id of ["error", "time", "hash", "asked"]) $(id).textContent = "–";
  $("exact").textContent = $("workers").textContent = "\u00a0";
  compare();
}

function showFacts() {
  const { says, took, planning, width, height } = state.shown;
  const error = says["anamorph:max_error"], exact = says["anamorph:exact_fraction"];
  $("error").textContent = error === undefined ? "–" : Number(error) === 0 ? "0" : Number(error).toPrecision(3);
  $("asked").textContent = says["anamorph:tol"] ?? $("tol").value;
  $("exact").textContent = exact === undefined ? "\u00a0" : `${round(100 * exact, 1)}% of the pixels exact`;
  $("time").textContent = `${took < 100 ? round(took, 1) : Math.round(took)} ms`;
  const count = workers.all.length;
  $("workers").textContent = `${width}×${height}, plan ${round(planning, 1)} ms, ${count} worker${count > 1 ? "s" : ""}`;
  showLook();
}

/// Once nothing moves any more: the hash, and what a screen reader says.
let settling = 0;
function settle() {
  clearTimeout(settling);
  $("hash").textContent = "…";
  compare();
  settling = setTimeout(async () => {
    const shown = state.shown;
    if (!shown || shown.recipe !== recipe() || state.source.isPreview) return;
    try {
      const { hash } = await workers.ask(0, { ask: "hash", recipe: shown.recipe, rgba: shown.rgba });
      if (shown !== state.shown) return;
      shown.hash = hash;
      $("hash").textContent = hash;
      compare();
      $("said").textContent = `Drawn. Proven error ${$("error").textContent} pixels, ${$("time").textContent}. Hash ${hash}. ${$("verdict").textContent}`;
    } catch (error) {
      report(error);
    }
  }, 150);
}

// ---- The hash of the desktop program ----

const known = new Map();
function readKnown() {
  for (const line of $("known").textContent.split("\n")) {
    const [, hash, text, title] = /^([0-9a-f]{32}) (\S+)(?: # (.*))?$/.exec(line) || [];
    if (hash) known.set(text, { hash, title });
  }
}

function compare() {
  const hash = state.shown?.hash, verdict = $("verdict"), typed = /[0-9a-f]{32}/i.exec($("desktop").value)?.[0].toLowerCase();
  const listed = state.source?.isSample && known.get(state.shown?.recipe)?.hash;
  const expected = typed || listed;
  verdict.className = hash && expected ? (hash === expected ? "same" : "other") : "";
  if (!hash) verdict.textContent = "Drawing…";
  else if (typed) verdict.textContent = hash === typed ? "The same bits as the desktop program." : "Another picture than the desktop program’s. Is it of the source that was saved here, and of this recipe?";
  else if (listed) verdict.textContent = hash === listed ? `The same bits as the desktop program, which prints ${listed}.` : `Other bits than the desktop program, which prints ${listed}.`;
  else verdict.textContent = "This view is not in the page’s list: run the second command below and paste what it prints.";
  if (!state.shown) verdict.textContent = "There is no picture.";
}

function showCommands() {
  const file = state.source?.file || "picture.png", text = recipe();
  const name = `"${file}.${text}"`;
  $("oiiotool").textContent = `oiiotool ${name} -o view.png`;
  $("command").textContent = `anamorph hash ${name}`;
  $("save-mesh").hidden = mode() !== "warp";
}

// ---- Looking around ----

function showLook() {
  const pano = mode() === "pano";
  const yaw = number("yaw"), pitch = number("pitch");
  $("view").setAttribute(
    "aria-label",
    pano
      ? `${$("to").value} view, ${Math.abs(yaw)} degrees ${yaw < 0 ? "left" : "right"}, ${Math.abs(pitch)} ${pitch < 0 ? "down" : "up"}, ${number("fov")} wide`
      : `The picture, drawn by ${mode() === "map" ? "a formula" : mode() === "lens" ? "a lens" : "a warp"}`,
  );
  $("view").classList.toggle("still", !pano);
  $("view-help").hidden = !pano;
  $("handles").hidden = mode() !== "warp";
}

function turnedDegrees(x) {
  return round(x - 360 * Math.floor((x + 180) / 360), 2);
}

/// Turns the camera by so many degrees, and changes its field of view by a factor.
function look(right, up, factor = 1) {
  if (mode() !== "pano") return;
  const fov = $("fov"), most = Number(fov.max);
  $("yaw").value = turnedDegrees(number("yaw") + right);
  $("pitch").value = clamp(number("pitch") + up, -90, 90);
  if (!fov.disabled) fov.value = clamp(number("fov") * factor, Math.min(5, most), most);
  changed(true);
}

/// Something was set. `moves`: more of the same is likely to come soon.
let stillness = 0;
function changed(moves = false) {
  showSettings();
  showCommands();
  if (state.shown) state.shown.hash = undefined;
  $("hash").textContent = "…";
  compare();
  clearTimeout(stillness);
  clearTimeout(settling);
  state.moving = moves;
  if (moves)
    stillness = setTimeout(() => {
      state.moving = false;
      if (state.shown?.recipe === recipe() && !state.busy) settle();
      else draw();
    }, 220);
  draw();
}

function lookByPointer() {
  const view = $("view"), fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  view.addEventListener("pointerdown", (event) => {
    view.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  view.addEventListener("pointermove", (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const before = fingers.size === 2 ? spread() : 0;
    const to = { x: event.clientX, y: event.clientY };
    fingers.set(event.pointerId, to);
    const degrees = Math.min(number("fov"), 180) / view.clientWidth / fingers.size;
    look((from.x - to.x) * degrees, (to.y - from.y) * degrees, before ? before / Math.max(1, spread()) : 1);
  });
  for (const end of ["pointerup", "pointercancel"]) view.addEventListener(end, (event) => fingers.delete(event.pointerId));
  view.addEventListener(
    "wheel",
    (event) => {
      if (mode() !== "pano") return;
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 16 : 1;
      look(0, 0, Math.exp(clamp(event.deltaY * lines, -100, 100) * 0.0015));
    },
    { passive: false },
  );
  view.addEventListener("keydown", (event) => {
    const step = number("fov") / (event.shiftKey ? 60 : 15);
    const keys = {
      ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step],
      "+": [0, 0, 0.9], "=": [0, 0, 0.9], "-": [0, 0, 1 / 0.9],
    };
    if (mode() !== "pano" || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Home") $("yaw").value = $("pitch").value = $("roll").value = 0;
    else if (!keys[event.key]) return;
    event.preventDefault();
    look(...(keys[event.key] || [0, 0]));
  });
}

// ---- The mesh of the warp: sixteen points ----

const flatMesh = () => Array.from({ length: 16 }, (_, i) => [round((i % 4) / 3, 4), round(Math.floor(i / 4) / 3, 4)]);
function waveMesh() {
  return flatMesh().map(([x, y], i) => (i % 4 && i % 4 < 3 && i > 3 && i < 12 ? [round(x + 0.09 * (i < 8 ? 1 : -1), 4), round(y + 0.07 * (i % 4 < 2 ? -1 : 1), 4)] : [x, y]));
}

async function setMesh(mesh, moves = false) {
  state.mesh = mesh;
  placeHandles();
  if (workers) workers.askAll({ ask: "file", name: "mesh.json", text: meshText() }).catch(report);
  if (state.shown) state.shown.recipe = null;
  if (mode() === "warp") changed(moves);
}

function makeHandles() {
  const place = $("handles");
  place.innerHTML = '<svg viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden="true"><path/></svg>';
  for (let i = 0; i < 16; ++i) {
    const handle = document.createElement("button");
    handle.type = "button";
    const move = (dx, dy) => setMesh(state.mesh.map((p, k) => (k === i ? [round(clamp(p[0] + dx, -0.5, 1.5), 4), round(clamp(p[1] + dy, -0.5, 1.5), 4)] : p)), true);
    handle.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 0.002 : 0.01;
      const keys = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
      if (!keys[event.key]) return;
      event.preventDefault();
      move(...keys[event.key]);
    });
    handle.addEventListener("pointerdown", (event) => {
      handle.setPointerCapture(event.pointerId);
      handle.from = [event.clientX, event.clientY];
    });
    handle.addEventListener("pointermove", (event) => {
      if (!handle.from) return;
      move((event.clientX - handle.from[0]) / place.clientWidth, (event.clientY - handle.from[1]) / place.clientHeight);
      handle.from = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) handle.addEventListener(end, () => (handle.from = null));
    place.append(handle);
  }
}

function placeHandles() {
  const at = (i) => state.mesh[i].join(" ");
  let path = "";
  for (let k = 0; k < 4; ++k) {
    path += `M${at(4 * k)}L${at(4 * k + 1)}L${at(4 * k + 2)}L${at(4 * k + 3)}`;
    path += `M${at(k)}L${at(4 + k)}L${at(8 + k)}L${at(12 + k)}`;
  }
  $("handles").querySelector("path").setAttribute("d", path);
  $("handles").querySelectorAll("button").forEach((handle, i) => {
    const [x, y] = state.mesh[i];
    handle.style.left = `${100 * x}%`;
    handle.style.top = `${100 * y}%`;
    handle.setAttribute("aria-label", `Point ${(i % 4) + 1} of row ${Math.floor(i / 4) + 1}: ${round(100 * x, 1)} percent across, ${round(100 * y, 1)} down`);
  });
}

// ---- Settings ----

const FORMULAS = [
  ["A whirl", "w=1.6*exp(-5*r^2)", "src_width/2+src_height/2*r*cos(a+w)", "src_height/2-src_height/2*r*sin(a+w)"],
  ["Ripples", "k=30*exp(-3*r^2)*sin(24*r)", "src_width*s+k*px", "src_height*t-k*py"],
  ["Little planet", "lon=a/(2*pi)+0.75;lat=atan(1.4*r)", "src_width*mod(lon,1)", "src_height*(1-2*lat/pi)"],
  ["Kaleidoscope", "n=8;w=2*pi/n;b=abs(mod(a,w)-w/2)", "src_width*(0.5+0.22*r*cos(b))", "src_height*(0.5-0.44*r*sin(b))"],
  ["A pinch", "k=r^0.6", "src_width/2+src_height/2*r*k*cos(a)", "src_height/2-src_height/2*r*k*sin(a)"],
  ["Waves", "", "src_width*s+12*sin(t*40)", "src_height*t+12*sin(s*60)"],
];

const VIEWS = () => [...known].filter(([text, { title }]) => title && text.startsWith("pano?"));

function fillSelects(described) {
  state.projections = new Map(described.projections.map((p) => [p.name, p]));
  const option = (select, value, label) => select.append(new Option(label, value));
  option($("from"), "", "told by its shape");
  for (const { name } of described.projections) {
    option($("from"), name, name.replaceAll("_", " "));
    option($("to"), name, name.replaceAll("_", " "));
  }
  $("to").value = "rectilinear";
  for (const choice of described.operations.pano.keys.filter.choices) option($("filter"), choice, choice.replaceAll("_", " "));
  $("filter").value = "antialias";
  FORMULAS.forEach(([title], i) => option($("formula"), i, title));
  option($("preset"), "", "as set below");
  VIEWS().forEach(([text, { title }]) => option($("preset"), text, title));
  $("version").textContent = described.version;
}

/// The settings that a recipe of the list says.
function applyRecipe(text) {
  const keys = new Map(text.slice(text.indexOf("?") + 1).split("&").map((part) => part.split(/=(.*)/s)));
  const set = (id, otherwise, key = id) => ($(id).value = keys.get(key) ?? otherwise);
  set("to", "rectilinear");
  limitFov();
  set("fov", state.projections.get($("to").value).fov);
  for (const id of ["yaw", "pitch", "roll"]) set(id, 0);
  set("d", 1);
  set("view-lens", "", "lens");
  set("size", "1280x720");
  set("filter", "antialias");
  set("tol", "0.01");
}

function limitFov() {
  const { most, open, fixed, fov } = state.projections.get($("to").value), range = $("fov");
  range.max = open ? most - 0.5 : most;
  range.disabled = fixed;
  if (fixed) range.value = fov;
}

// Projections with faces are drawn where those are square.
function fitSize() {
  const { columns, rows } = state.projections.get($("to").value);
  const fits = ({ value }) => value.split("x")[0] * rows === value.split("x")[1] * columns;
  const sizes = [...$("size").options];
  if (columns && !sizes.some((size) => size.selected && fits(size))) $("size").value = sizes.find(fits).value;
}

const FLAT = new Set(["rectilinear", "fisheye", "equisolid", "stereographic", "orthographic", "pannini", "cylindrical", "equirectangular", "dual_fisheye", "dual_fisheye_tb", "mercator"]);
function showSettings() {
  for (const part of document.querySelectorAll("[data-mode]")) part.hidden = part.dataset.mode !== mode();
  $("from-row").hidden = mode() !== "pano";
  $("srcfov-row").hidden = mode() !== "pano" || !FLAT.has($("from").value);
  $("d-row").hidden = !["pannini", "unified"].includes($("to").value);
  $("strength-row").hidden = !$("lens-model").value;
  for (const output of document.querySelectorAll("output[for]")) {
    const input = $(output.htmlFor[0]);
    output.textContent = `${round(Number(input.value), 2)}${["fov", "yaw", "pitch", "roll", "lens-fov"].includes(input.id) ? "°" : ""}`;
  }
  if ([...$("preset").options].some((o) => o.value === recipe())) $("preset").value = recipe();
  else $("preset").value = "";
}

function writeLens() {
  const model = $("lens-model").value;
  if (model) $("lens").value = model.replace("%", number("strength"));
}
function writeFormula() {
  const [, definitions, u, v] = FORMULAS[$("formula").value];
  $("let").value = definitions;
  $("u").value = u;
  $("v").value = v;
}

// ---- The source ----

async function takeImage(rgba, width, height, source) {
  await workers.askAll({ ask: "image", rgba, width, height });
  state.source = { ...source, width, height };
  $("source-name").textContent = `${source.name}, ${width}×${height}. Nothing leaves this machine.`;
  $("busy").hidden = true;
}

function busy(text) {
  $("busy").querySelector("span").textContent = text;
  $("busy").hidden = false;
}

/// Our panorama: a small one first, which is there at once, then as it is meant.
async function takeSample() {
  const name = { name: "Our panorama", file: "panorama.png", isSample: SAMPLE_HEIGHT === LISTED_HEIGHT };
  busy("Making the panorama…");
  state.source = null;
  await workers.askAll({ ask: "sample", height: 256 });
  state.source = { ...name, isSample: false, isPreview: true, width: 512, height: 256 };
  $("hash").textContent = "…";
  await draw();
  const { width, height } = await workers.ask(0, { ask: "sample", height: SAMPLE_HEIGHT });
  const { pixels } = await workers.ask(0, { ask: "pixels", width, height });
  await takeImage(withAlpha(pixels), width, height, name);
  changed();
}
/// That of the panorama of which hashes are listed; tests ask for another.
const LISTED_HEIGHT = 2048;
const SAMPLE_HEIGHT = Number(new URLSearchParams(location.search).get("sample")) || LISTED_HEIGHT;

function withAlpha(rgb) {
  const rgba = new Uint8ClampedArray((rgb.length / 3) * 4);
  for (let i = 0, k = 0; i < rgb.length; i += 3, k += 4) {
    rgba[k] = rgb[i];
    rgba[k + 1] = rgb[i + 1];
    rgba[k + 2] = rgb[i + 2];
    rgba[k + 3] = 255;
  }
  return rgba;
}

/// The most pixels of a picture that is taken: each worker has a copy.
const MOST_PIXELS = 160e6;
async function takeFile(file) {
  if (!file) return;
  busy("Reading the picture…");
  try {
    const bitmap = await createImageBitmap(file, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
    const { width, height } = bitmap;
    if (width * height > MOST_PIXELS) throw new Error(`${file.name} has ${Math.round((width * height) / 1e6)} million pixels: must be at most ${MOST_PIXELS / 1e6} million`);
    const canvas = new OffscreenCanvas(width, height), context = canvas.getContext("2d", { colorSpace: "srgb" });
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    bitmap.close();
    await takeImage(data, width, height, { name: file.name, file: `${file.name.replace(/\.[^.]*$/, "").replace(/[^\w-]+/g, "_") || "picture"}.png` });
    $("from").value = width === 2 * height || height === 6 * width ? "" : "rectilinear";
    changed();
  } catch (error) {
    $("busy").hidden = true;
    report(error.name === "InvalidStateError" || error.name === "EncodingError" ? new Error(`${file.name}: the browser cannot read it as a picture`) : error);
  }
}

// ---- Files to save ----

const CRCS = Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});
function crc(bytes) {
  let c = 0xffffffff;
  for (const byte of bytes) c = CRCS[(c ^ byte) & 255] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

/// A PNG of red, green and blue: what a canvas writes has alpha too, and would be another picture.
async function png(rgb, width, height) {
  const rows = new Uint8Array((3 * width + 1) * height);
  for (let y = 0; y < height; ++y) rows.set(rgb.subarray(3 * width * y, 3 * width * (y + 1)), (3 * width + 1) * y + 1);
  const packed = new Uint8Array(await new Response(new Blob([rows]).stream().pipeThrough(new CompressionStream("deflate"))).arrayBuffer());
  const chunk = (name, data) => {
    const bytes = new Uint8Array(12 + data.length), view = new DataView(bytes.buffer);
    view.setUint32(0, data.length);
    bytes.set([...name].map((c) => c.charCodeAt(0)), 4);
    bytes.set(data, 8);
    view.setUint32(8 + data.length, crc(bytes.subarray(4, 8 + data.length)));
    return bytes;
  };
  const head = new Uint8Array(13), view = new DataView(head.buffer);
  view.setUint32(0, width);
  view.setUint32(4, height);
  head.set([8, 2, 0, 0, 0], 8);
  return new Blob([Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10), chunk("IHDR", head), chunk("IDAT", packed), chunk("IEND", new Uint8Array())], { type: "image/png" });
}

function save(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function sourcePng() {
  const { width, height } = state.source;
  const { pixels } = await workers.ask(0, { ask: "pixels", width, height });
  return png(pixels, width, height);
}
function viewPng() {
  const { rgba, width, height } = state.shown, rgb = new Uint8Array(3 * width * height);
  for (let i = 0, k = 0; i < rgb.length; i += 3, k += 4) rgb.set(rgba.subarray(k, k + 3), i);
  return png(rgb, width, height);
}

// ---- Speed ----

async function measure(count = 60) {
  const button = $("measure"), yaw = number("yaw"), times = [];
  button.disabled = true;
  while (state.busy) await new Promise((done) => setTimeout(done, 20));
  state.busy = true;
  const askForTurned = (i) => {
    $("yaw").value = turnedDegrees(yaw + (360 * i) / count);
    return askFor(recipe());
  };
  const started = performance.now();
  for (let i = 0, asked = askForTurned(0); i < count; ++i) {
    const view = await asked;
    if (i + 1 < count) asked = askForTurned(i + 1);
    show(view);
    if (view.error) break;
    times.push(view.took);
    await new Promise((done) => requestAnimationFrame(done));
  }
  const rate = (1000 * count) / (performance.now() - started);
  times.sort((a, b) => a - b);
  $("yaw").value = yaw;
  $("measured").textContent = `${round(rate, 1)} views a second; half of them took at most ${round(times[count >> 1] || NaN, 1)} ms, the slowest ${round(times[count - 1] || NaN, 1)}.`;
  button.disabled = false;
  state.busy = false;
  changed();
  return { rate, median: times[count >> 1], slowest: times[count - 1] };
}

// ---- The page ----

function listen() {
  const on = (id, event, then) => $(id).addEventListener(event, then);
  for (const id of ["fov", "yaw", "pitch", "roll", "d", "lens-fov", "amount"]) on(id, "input", () => changed(true));
  for (const id of ["from", "srcfov", "view-lens", "lens", "lens-mode", "let", "u", "v", "tol", "filter", "size"]) on(id, "change", () => changed());
  on("to", "change", () => {
    limitFov();
    fitSize();
    $("fov").value = state.projections.get($("to").value).fov;
    changed();
  });
  on("preset", "change", () => {
    if ($("preset").value) applyRecipe($("preset").value);
    changed();
  });
  for (const id of ["lens-model", "strength"]) on(id, "input", () => (writeLens(), changed(id === "strength")));
  on("lens", "input", () => ($("lens-model").value = ""));
  on("formula", "change", () => (writeFormula(), changed()));
  on("coarse", "change", () => changed());
  for (const radio of document.getElementsByName("mode")) radio.addEventListener("change", () => changed());
  on("desktop", "input", compare);
  on("mesh-wave", "click", () => setMesh(waveMesh()));
  on("mesh-flat", "click", () => setMesh(flatMesh()));
  on("measure", "click", () => measure());
  on("choose", "click", () => $("file").click());
  on("file", "change", () => takeFile($("file").files[0]).then(() => ($("file").value = "")));
  on("sample", "click", () => takeSample().catch(report));
  on("save-source", "click", async () => state.source && save(await sourcePng(), state.source.file));
  on("save-view", "click", async () => state.shown && save(await viewPng(), "view.png"));
  on("save-mesh", "click", () => save(new Blob([meshText()], { type: "application/json" }), "mesh.json"));
  for (const button of document.querySelectorAll("[data-copy]"))
    button.addEventListener("click", async () => {
      const text = $(button.dataset.copy);
      try {
        await navigator.clipboard.writeText(text.textContent);
        $("copied").textContent = "Copied.";
      } catch {
        getSelection().selectAllChildren(text);
        $("copied").textContent = "Selected: copy it with the keyboard.";
      }
    });
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  const leaves = (event) => !event.relatedTarget;
  addEventListener("dragover", (event) => {
    event.preventDefault();
    $("drop").hidden = false;
  });
  addEventListener("dragleave", (event) => leaves(event) && ($("drop").hidden = true));
  addEventListener("drop", (event) => {
    event.preventDefault();
    $("drop").hidden = true;
    takeFile(event.dataTransfer.files[0]);
  });
  addEventListener("paste", (event) => takeFile([...(event.clipboardData?.files || [])][0]));
}

async function begin() {
  const asked = Number(new URLSearchParams(location.search).get("workers"));
  workers = await Workers.start(clamp(asked || navigator.hardwareConcurrency || 1, 1, 8));
  readKnown();
  fillSelects(await workers.ask(0, { ask: "describe" }));
  makeHandles();
  writeLens();
  writeFormula();
  await setMesh(waveMesh());
  lookByPointer();
  listen();
  limitFov();
  const [first] = VIEWS();
  if (first) applyRecipe(first[0]);
  showSettings();
  showCommands();
  await takeSample();
}

begin().catch((error) => {
  $("busy").hidden = true;
  report(new Error(`The page needs a newer browser, with WebAssembly’s vectors and exceptions. ${error.message}`));
});
