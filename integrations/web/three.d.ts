import type { Doors, Place, Table } from "./index.js";

/** What is used of an object of three.js. */
export interface Object3DLike {
  name: string;
  userData: Record<string, any>;
  parent: Object3DLike | null;
  traverse(callback: (object: any) => any): void;
}

/** A BatchedMesh, and for each of its instances the object of the table that it shows, or -1. */
export interface Batch {
  readonly mesh: any;
  readonly objects: ArrayLike<number> & { forEach(call: (object: number, instance: number) => void): void };
}

export interface CullOptions {
  /** What the loader of glTF gave: objects are then found by their nodes and primitives, which the table states. */
  readonly gltf?: { readonly scene: any; readonly parser?: { readonly associations?: Map<any, any> } };
  /** What has the coordinates of the table: the scene of the glTF, or else the whole scene. */
  readonly root?: Object3DLike;
  /** Finds the objects of the table that an object shows; null for one that is always drawn. Without, by node and primitive, or by name. */
  readonly find?: (object: any) => readonly number[] | null;
  /** Whether to follow portals in view in each frame, which hides more and costs more. */
  readonly narrow?: boolean;
  /** Which doors are shut. */
  readonly doors?: Doors | null;
  readonly batches?: readonly Batch[];
}

/** What `cull` returns. */
export interface Culling {
  /** Where the camera was in the last frame. */
  readonly place?: Place;
  /** The objects of the scene that were not drawn in the last frame, each with its objects of the table. */
  readonly hidden: readonly { readonly object: any; readonly ids: readonly number[] }[];
  /** The objects of the scene that the table has. */
  readonly meshes: readonly { readonly object: any; readonly ids: readonly number[] }[];
  /** Looks for the objects of the scene anew, after some were added or removed. */
  update(): this;
  /** Draws everything again. */
  dispose(): void;
}

/** Draws for this camera only what the table says may be seen from it. Shadows and other cameras keep everything. */
export function cull(scene: Object3DLike, table: Table, camera: any, options?: CullOptions): Culling;
