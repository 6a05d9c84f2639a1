// The replay engine in WebAssembly (tools/wasm/engine.cpp): text goes in, JSON comes out, and what it
// refuses is thrown with its words. Also runs in the worker of flights: it uses nothing of the page.

class ReplayEngine {
  /** @param onFrame  (number, latency in ns), called while a flight is timed */
  constructor(module, onFrame = () => {}) {
    const page = {
      fail: (at, size) => {
        throw new Error(this.text(at, size));
      },
      frame: onFrame
    };
    const nothing = () => 0;
    const system = {
      environ_get: nothing,
      environ_sizes_get: (count, size) => {
        const words = new DataView(this.exports.memory.buffer);
        words.setUint32(count, 0, true);
        words.setUint32(size, 0, true);
        return 0;
      },
      fd_close: nothing,
      fd_seek: nothing,
      fd_write: nothing,
      proc_exit: () => {
        throw new Error('the engine stopped');
      }
    };
    this.exports = new WebAssembly.Instance(module, {page, wasi_snapshot_preview1: system}).exports;
    this.exports._initialize();
  }

  text(at, size) {
    return new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, at, size));
  }

  /** What an export answers. @param parts  bytes that it reads, one behind the other */
  call(name, parts, ...values) {
    const stack = this.exports.__stack_pointer.value;
    try {
      let at = this.exports.input(parts.reduce((size, part) => size + part.length, 0));
      const memory = new Uint8Array(this.exports.memory.buffer);
      for (const part of parts) {
        memory.set(part, at);
        at += part.length;
      }
      const size = this.exports[name](...values);
      return JSON.parse(this.text(this.exports.output(), size));
    } catch (error) {
      this.exports.__stack_pointer.value = stack;  // the call did not come to its end
      throw error;
    }
  }

  ask(name, text, ...values) {
    return this.call(name, [new TextEncoder().encode(text)], ...values);
  }

  load(trace, chip) {
    this.call('load', [trace, new TextEncoder().encode(JSON.stringify(chip))], trace.length);
  }

  /** @param lines  "cluster.fpu.units=2", "fps=40" */
  set(lines) {
    return this.ask('set', lines.join('\n'));
  }
  /** Why settings cannot run, or null. */
  refusal(lines) {
    try {
      return this.ask('refusal', lines.join('\n'));
    } catch (error) {
      return error.message;
    }
  }
  frame(number) {
    return this.ask('frame', '', number);
  }
  /** What the setting adds to that of other lines; null if they cannot run. */
  price(number, lines) {
    try {
      return this.ask('price', lines.join('\n'), number);
    } catch {
      return null;
    }
  }
  /** @param everything  all statistics, and times on one core */
  flight(everything = false) {
    return this.ask('flight', '', everything ? 1 : 0);
  }
}

/** Bytes that the page holds in base64 and gzip. */
async function unpacked(id) {
  const packed =
      Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
