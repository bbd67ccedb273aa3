// SPDX-License-Identifier: Apache-2.0
// One of the page's workers, which has an image and a plan of its own: messages in, answers out, in the same order. It is run behind the
// glue of emscripten, which defines createAnamorph; node runs it too (tests/web).
"use strict";

class Core {
  constructor(module) {
    this.m = module;
    this.recipe = null;
    this.planned = null;
  }

  /// Calls a function of web.cpp with texts and numbers; throws what it says.
  ask(name, ...args) {
    const m = this.m, rooms = [];
    const values = args.map((value) => {
      if (typeof value !== "string") return value;
      const bytes = m.lengthBytesUTF8(value) + 1, room = m._anamorph_room(bytes);
      m.stringToUTF8(value, room, bytes);
      rooms.push(room);
      return room;
    });
    const answer = JSON.parse(m.UTF8ToString(m["_anamorph_" + name](...values)));
    rooms.forEach((room) => m._anamorph_free(room));
    if (answer.error) throw new Error(answer.error);
    return answer;
  }

  /// Lends memory of the core for the time of `use`.
  withRoom(bytes, use) {
    const room = this.m._anamorph_room(bytes);
    if (!room) throw new Error("not enough memory for the picture");
    try {
      return use(room);
    } finally {
      this.m._anamorph_free(room);
    }
  }

  image(rgba, width, height) {
    this.recipe = null;
    return this.withRoom(rgba.length, (room) => {
      this.m.HEAPU8.set(rgba, room);
      return this.ask("image", room, width, height);
    });
  }

  sample(height) {
    this.recipe = null;
    return this.ask("sample", height);
  }

  /// Red, green and blue of the image.
  imagePixels(width, height) {
    const from = this.m._anamorph_image_pixels();
    return this.m.HEAPU8.slice(from, from + 3 * width * height);
  }

  file(name, text) {
    this.recipe = null;
    return this.ask("file", name, text);
  }

  plan(recipe) {
    if (recipe !== this.recipe) {
      this.recipe = null;
      this.planned = this.ask("plan", recipe);
      this.recipe = recipe;
    }
    return this.planned;
  }

  /// Rows y0 to y1 of the picture that is planned: red, green, blue and alpha.
  draw(y0, y1) {
    const bytes = 4 * this.planned.width * (y1 - y0);
    return this.withRoom(bytes, (room) => {
      this.ask("draw", y0, y1, room);
      return this.m.HEAPU8.slice(room, room + bytes);
    });
  }

  /// The hash of the picture that is planned, whose pixels these are.
  hash(rgba) {
    return this.withRoom(rgba.length, (room) => {
      this.m.HEAPU8.set(rgba, room);
      return this.ask("hash", room).hash;
    });
  }
}

/// The part of a picture that worker `i` of `count` draws: rows, as even as can be.
function rowsOf(height, i, count) {
  return [Math.floor((height * i) / count), Math.floor((height * (i + 1)) / count)];
}

/// What a message asks for: [answer, buffers that go with it].
function answerTo(core, message) {
  switch (message.ask) {
    case "describe":
      return [core.ask("describe"), []];
    case "image":
      return [core.image(message.rgba, message.width, message.height), []];
    case "sample":
      return [core.sample(message.height), []];
    case "pixels": {
      const pixels = core.imagePixels(message.width, message.height);
      return [{ pixels }, [pixels.buffer]];
    }
    case "file":
      return [core.file(message.name, message.text), []];
    case "view": {
      const started = performance.now(), plan = core.plan(message.recipe), planned = performance.now();
      const [y0, y1] = rowsOf(plan.height, message.part, message.parts), pixels = core.draw(y0, y1);
      return [{ ...plan, y0, pixels, planning: planned - started, drawing: performance.now() - planned }, [pixels.buffer]];
    }
    case "hash":
      core.plan(message.recipe);
      return [{ hash: core.hash(message.rgba) }, []];
  }
  throw new Error("no such question: " + message.ask);
}

if (typeof importScripts === "function") {
  let core = null, queue = Promise.resolve();
  const start = (wasm) =>
    createAnamorph({
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(wasm, imports).then((instance) => done(instance));
        return {};
      },
    }).then((module) => {
      core = new Core(module);
    });
  self.onmessage = ({ data }) => {
    queue = queue
      .then(async () => {
        if (data.ask === "start") {
          await start(data.wasm);
          return [{}, []];
        }
        return answerTo(core, data);
      })
      .then(([answer, buffers]) => self.postMessage({ id: data.id, answer }, buffers))
      .catch((error) => self.postMessage({ id: data.id, error: String(error.message || error) }));
  };
} else {
  module.exports = { Core, rowsOf };
}
