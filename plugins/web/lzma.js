// SPDX-License-Identifier: Apache-2.0
// Unpacks a file .lzma, as `xz --format=lzma` makes it, which has a quarter less bytes than gzip makes of the core; browsers have no
// function for it. After the LZMA specification that comes with 7-Zip (2015, public domain), whose names these are.
"use strict";

/// The `size` bytes that were packed.
function unpackLzma(packed, size) {
  const lc = packed[0] % 9, lp = Math.floor(packed[0] / 9) % 5, pb = Math.floor(packed[0] / 45);
  const out = new Uint8Array(size);

  // The range decoder: behind the header of 13 bytes a 0, the first 4 bytes of the code, and what follows.
  let range = 0xffffffff, code = 0, at = 14;
  const shift = () => {
    code = ((code << 8) | packed[at++]) >>> 0;
  };
  for (let i = 0; i < 4; ++i) shift();
  const normalize = () => {
    if (range >= 0x1000000) return;
    range = (range << 8) >>> 0;
    shift();
  };
  /// A bit whose probability to be 0 is probs[i] of 2048.
  const bit = (probs, i) => {
    const bound = (range >>> 11) * probs[i], one = code >= bound;
    if (one) {
      range -= bound;
      code -= bound;
      probs[i] -= probs[i] >> 5;
    } else {
      range = bound;
      probs[i] += (2048 - probs[i]) >> 5;
    }
    normalize();
    return one ? 1 : 0;
  };
  const directBits = (count) => {
    let value = 0;
    while (count-- > 0) {
      range >>>= 1;
      const one = code >= range;
      if (one) code -= range;
      normalize();
      value = 2 * value + (one ? 1 : 0);
    }
    return value;
  };
  const bitTree = (probs, first, bits) => {
    let m = 1;
    for (let i = 0; i < bits; ++i) m = 2 * m + bit(probs, first + m);
    return m - (1 << bits);
  };
  const reverseBitTree = (probs, first, bits) => {
    let m = 1, symbol = 0;
    for (let i = 0; i < bits; ++i) {
      const b = bit(probs, first + m);
      m = 2 * m + b;
      symbol |= b << i;
    }
    return symbol;
  };

  const probs = (count) => new Uint16Array(count).fill(1024);
  const lengthDecoder = () => ({ choice: probs(2), low: probs(16 << 3), mid: probs(16 << 3), high: probs(256) });
  const lengthOf = (d, posState) => {
    if (!bit(d.choice, 0)) return bitTree(d.low, posState << 3, 3);
    if (!bit(d.choice, 1)) return 8 + bitTree(d.mid, posState << 3, 3);
    return 16 + bitTree(d.high, 0, 8);
  };
  const isMatch = probs(12 << 4), isRep0Long = probs(12 << 4), isRep = probs(12), isRepG0 = probs(12), isRepG1 = probs(12), isRepG2 = probs(12);
  const literals = probs(0x300 << (lc + lp)), posSlots = probs(4 << 6), posDecoders = probs(115), align = probs(16);
  const matchLength = lengthDecoder(), repLength = lengthDecoder();

  let n = 0, state = 0, rep = [0, 0, 0, 0];
  const literal = () => {
    const previous = n ? out[n - 1] : 0, first = 0x300 * (((n & ((1 << lp) - 1)) << lc) + (previous >> (8 - lc)));
    let symbol = 1;
    for (let match = state >= 7 ? out[n - rep[0] - 1] : -1; match >= 0 && symbol < 0x100; match = (match << 1) & 0xff) {
      const expected = match >> 7, b = bit(literals, first + ((1 + expected) << 8) + symbol);
      symbol = 2 * symbol + b;
      if (b !== expected) break;
    }
    while (symbol < 0x100) symbol = 2 * symbol + bit(literals, first + symbol);
    out[n++] = symbol;
    state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
  };
  const distance = (length) => {
    const slot = bitTree(posSlots, Math.min(length, 3) << 6, 6);
    if (slot < 4) return slot;
    const bits = (slot >> 1) - 1, least = (2 | (slot & 1)) * 2 ** bits;
    if (slot < 14) return least + reverseBitTree(posDecoders, least - slot, bits);
    return least + 16 * directBits(bits - 4) + reverseBitTree(align, 0, 4);
  };

  while (n < size) {
    if (!(at <= packed.length + 4)) throw new Error("what is packed ends too soon");
    const posState = n & ((1 << pb) - 1);
    let length;
    if (!bit(isMatch, (state << 4) + posState)) {
      literal();
      continue;
    } else if (!bit(isRep, state)) {
      length = lengthOf(matchLength, posState);
      state = state < 7 ? 7 : 10;
      rep = [distance(length), rep[0], rep[1], rep[2]];
    } else {
      const which = !bit(isRepG0, state) ? 0 : !bit(isRepG1, state) ? 1 : !bit(isRepG2, state) ? 2 : 3;
      const isLong = which > 0 || bit(isRep0Long, (state << 4) + posState);
      rep = [rep[which], ...rep.filter((_, i) => i !== which)];
      length = isLong ? lengthOf(repLength, posState) : -1;
      state = isLong ? (state < 7 ? 8 : 11) : state < 7 ? 9 : 11;
    }
    if (rep[0] >= n) throw new Error("what is packed is damaged");
    for (const end = Math.min(size, n + length + 2); n < end; ++n) out[n] = out[n - rep[0] - 1];
  }
  return out;
}

if (typeof module === "object") module.exports = { unpackLzma };
