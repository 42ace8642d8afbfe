/** What a table has. */
export interface Facts {
  cells: number;
  objects: number;
  dimension: 2 | 3;
  /** What decided, in scenes in space. */
  method: string | null;
}

/** How far a bake is: the phase in a word or two, and how much of it is done, from 0 to 1. */
export type Tell = (phase: string, share: number) => void;

export interface AskOptions {
  tell?: Tell;
  /** Ends the question, and the worker. */
  signal?: AbortSignal;
}

/** Options of `sightlines build`, with `_` for `-`; and which map of a WAD. */
export interface Request {
  map?: string | null;
  [option: string]: unknown;
}

/** The module in a worker, which makes tables of files. One question at a time. */
export class Baker {
  constructor(module: WebAssembly.Module);
  /** From the bytes of the module (`sightlines/sightlines.wasm`), a Response, or its address. */
  static load(source: BufferSource | Response | string | URL | WebAssembly.Module): Promise<Baker>;
  /** Makes the table of a file, as the program does: the bytes of a plain table. Rejects what is no scene, plan or map, and what means nothing for it. */
  bake(file: { name: string; bytes: Uint8Array }, request?: Request, options?: AskOptions): Promise<{ table: Uint8Array; facts: Facts }>;
  /** The last table as one HTML file, with the scene to walk through. */
  page(title: string, options?: AskOptions): Promise<string>;
  /** Ends the worker; what is being made is lost. */
  stop(reason?: unknown): void;
}

/** The module on the thread that asks, as for Node. */
export class Instance {
  constructor(module: WebAssembly.Module, tell?: Tell);
  /** A question as the crate `wasm` documents it. Throws an Error for what cannot be answered. */
  ask(question: object, bytes?: Uint8Array): { json: any; bytes: Uint8Array };
}
