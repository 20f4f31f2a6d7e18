"use strict";
// Arrays of a run, from one base64 text: each is deflated on its own, positions are second differences in time.

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

function bytesOf(base64) {
  const text = atob(base64.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const TYPES = { float32: Float32Array, uint8: Uint8Array, uint32: Uint32Array };

// Name -> typed array, for every array of the run but positions, which come as whole numbers [frame][grain][axis].
async function decode(data, base64) {
  const bytes = bytesOf(base64);
  const found = {};
  await Promise.all(Object.entries(data.arrays).map(async ([name, about]) => {
    const buffer = await inflate(bytes.subarray(about.from, about.from + about.bytes));
    found[name] = new TYPES[about.type](buffer);
  }));
  found.x = summed(found.x, data.arrays.x.shape);
  for (const one of data.colourings) {
    const about = data.arrays[one.word];
    if (about && about.differences) addUp(found[one.word], about.shape[1]);
  }
  return found;
}

function summed(split, [places, axes, frames, grains]) {
  const whole = new Int32Array(axes * frames * grains);
  const plane = axes * frames * grains;
  for (let axis = 0; axis < axes; axis++) {
    for (let k = 0; k < frames; k++) {
      for (let g = 0; g < grains; g++) {
        const at = (axis * frames + k) * grains + g;
        let folded = 0;
        for (let place = places - 1; place >= 0; place--) folded = folded * 256 + split[place * plane + at];
        let value = folded % 2 ? -(folded + 1) / 2 : folded / 2;
        const to = (k * grains + g) * axes + axis, before = grains * axes;
        if (k === 1) value += whole[to - before];
        if (k > 1) value += 2 * whole[to - before] - whole[to - 2 * before];
        whole[to] = value;
      }
    }
  }
  return whole;
}

function addUp(levels, row) {
  for (let i = row; i < levels.length; i++) levels[i] = (levels[i] + levels[i - row]) & 255;
}
