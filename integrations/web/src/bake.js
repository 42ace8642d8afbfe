// Making tables in a page: the module of WebAssembly in a worker.

/** An instance of the module. It answers one question at a time, on the thread that asks. */
export class Instance {
  /** `tell` is told the phase of a bake, and how much of it is done, from 0 to 1. */
  constructor(module, tell = () => {}) {
    [this.encoder, this.decoder] = [new TextEncoder(), new TextDecoder()];
    const progress = (place, length, share) => tell(this.decoder.decode(this.view(place, length)), share);
    this.exports = new WebAssembly.Instance(module, { page: { progress } }).exports;
  }

  view(place, length) {
    // Memory grows, and then its buffer is another one.
    return new Uint8Array(this.exports.memory.buffer, place >>> 0, length >>> 0);
  }

  part(which) {
    return this.view(this.exports.answer_place(which), this.exports.answer_length(which));
  }

  /**
   * Answers a question. Throws an Error with `isRefused` for what cannot be answered; after any other one, such as for want of memory, the instance is of
   * no more use.
   */
  ask(question, bytes = new Uint8Array()) {
    const text = this.encoder.encode(JSON.stringify(question));
    const room = this.view(this.exports.reserve(text.length + bytes.length), text.length + bytes.length);
    room.set(text);
    room.set(bytes, text.length);
    this.exports.answer(text.length);
    const json = JSON.parse(this.decoder.decode(this.part(0)));
    if (json.error !== undefined) throw Object.assign(new Error(json.error), { isRefused: true });
    return { json, bytes: this.part(1).slice() };
  }
}

/** What the worker does. It is given as text, so it names nothing from outside. */
function serve(Instance) {
  let instance = null;
  self.onmessage = ({ data: { module, question, bytes } }) => {
    try {
      instance ??= new Instance(module, (phase, share) => self.postMessage({ phase, share }));
      const { json, bytes: found } = instance.ask(question, bytes);
      self.postMessage({ json, bytes: found }, [found.buffer]);
    } catch (error) {
      if (!error.isRefused) instance = null;
      self.postMessage({ error: error.isRefused ? error.message : `the module stopped: ${error.message ?? error}` });
    }
  };
}

/** The module in a worker, so that the page stays alive. */
export class Baker {
  constructor(module) {
    this.module = module;
    this.worker = null;
    /** The question that is being answered. */
    this.pending = null;
  }

  /** From the bytes of the module, a Response, or its address. */
  static async load(source) {
    if (source instanceof WebAssembly.Module) return new Baker(source);
    const body = typeof source === "string" || source instanceof URL ? await fetch(source) : source;
    if (body.ok === false) throw new Error(`${body.url || source} was answered by ${body.status} ${body.statusText}`);
    return new Baker(await WebAssembly.compile(body.arrayBuffer ? await body.arrayBuffer() : body));
  }

  start() {
    const address = URL.createObjectURL(new Blob([`(${serve})(${Instance});`], { type: "text/javascript" }));
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.onmessage = ({ data }) => {
      if (data.phase !== undefined) return this.pending?.tell(data.phase, data.share);
      const { resolve, reject } = this.pending ?? { resolve() {}, reject() {} };
      this.pending = null;
      if (data.error === undefined) resolve(data);
      else reject(new Error(data.error));
    };
    this.worker.onerror = (event) => this.stop(new Error(event.message || "the worker failed"));
  }

  /** Ends the worker; what is being made is lost. */
  stop(reason = new DOMException("stopped", "AbortError")) {
    this.worker?.terminate();
    this.worker = null;
    const { pending } = this;
    this.pending = null;
    pending?.reject(reason);
  }

  /** Asks the module. One question at a time; `signal` ends it, and the worker. */
  ask(question, bytes, { tell = () => {}, signal } = {}) {
    if (this.pending) return Promise.reject(new Error("a question is being answered"));
    if (signal?.aborted) return Promise.reject(signal.reason);
    const stop = () => this.stop(signal.reason);
    const answer = new Promise((resolve, reject) => {
      if (!this.worker) this.start();
      this.worker.postMessage({ module: this.module, question, bytes });
      this.pending = { resolve, reject, tell };
      signal?.addEventListener("abort", stop, { once: true });
    });
    return answer.finally(() => signal?.removeEventListener("abort", stop));
  }

  /**
   * Makes the table of a file: `table` has the bytes of a plain table, as the program makes them, and `facts` say what it has.
   * @param file     its name, whose ending may tell the format, and its bytes
   * @param request  options of `sightlines build`, with `_` for `-`; and `map`, which map of a WAD
   */
  async bake({ name, bytes }, { map = null, ...request } = {}, options) {
    const { json, bytes: table } = await this.ask({ ask: "bake", name, map, request }, bytes, options);
    return { table, facts: json };
  }

  /** The last table as one HTML file, with the scene to walk through. */
  async page(title, options) {
    return new TextDecoder().decode((await this.ask({ ask: "page", title }, undefined, options)).bytes);
  }
}
