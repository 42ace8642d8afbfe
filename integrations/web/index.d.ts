/** A list of two or three numbers, or an object with `x`, `y` and perhaps `z`, such as the vectors of engines. In scene units. */
export type Point = ArrayLike<number> | { readonly x: number; readonly y: number; readonly z?: number };

/** An eye-to-cell method, each within the one before. */
export type Method = "cell-to-cell" | "disjoint-cell" | "connected-component" | "incident-portals" | "exact";

/** All methods. */
export const METHODS: readonly Method[];

/** What is wrong with a file, in words for its user. */
export class TableError extends Error {}

/** A cell of the table. */
export interface Cell {
  /** The box around it, along the axes of the table; z is 0 in a plane. */
  readonly min: readonly number[];
  readonly max: readonly number[];
  /** What the scene calls its region, such as the sector of a Doom map. */
  readonly group: number | null;
  /** The corners in a plane, counter-clockwise; none if the cell is its box. */
  readonly polygon: readonly (readonly number[])[];
  readonly name: string | null;
}

/** An opening between two cells. */
export interface Portal {
  readonly cells: readonly [number, number];
  readonly points: readonly (readonly number[])[];
}

/** An object of the scene. */
export interface Item {
  /** Its place in `Table.objects`. */
  readonly id: number;
  readonly name: string;
  /** The box around it, along the axes of the table. */
  readonly min: readonly number[];
  readonly max: readonly number[];
  /** How many polygons it has; 0 if that is not known. */
  readonly polygons: number;
  /** The node and the primitive of a glTF that it is, if it is of one and the table states it. */
  readonly node: number | null;
  readonly primitive: number | null;
}

/** What closes portals while it is shut. */
export interface Door {
  readonly name: string;
  readonly object: number | null;
  readonly portals: readonly number[];
}

/** A camera: by a direction and the horizontal angle in radians, below half a turn; or by the sixteen numbers of projection times view, by columns. */
export type View =
  | { readonly direction: Point; readonly fov: number; readonly aspect?: number; readonly up?: Point }
  | { readonly viewProjection: ArrayLike<number> };

/** How to narrow. */
export interface NarrowOptions {
  /** `exact` unless it is stated. */
  readonly method?: Method;
  /** All are open unless they are given. */
  readonly doors?: Doors | null;
}

/** What may be seen. */
export interface Visible {
  readonly table: Table;
  /** Whether an object may be seen. */
  sees(object: number): boolean;
  /** Whether something in a cell may be seen. */
  seesCell(cell: number): boolean;
  /** The objects that may be seen, ascending. */
  objects(): number[];
  /** The cells that may be seen, ascending. */
  visibleCells(): number[];
}

/** What may be seen from a point: from outside of all cells everything, since nothing is known there. */
export interface Place extends Visible {
  readonly point: readonly number[];
  /** The cells with the point, ascending: none outside, several on borders. */
  readonly cells: readonly number[];
  readonly isOutside: boolean;
  /** The objects that may be seen as bits, the lowest of each word first. Not to be written to. */
  readonly objectBits: Uint32Array;
  /** The same for cells. */
  readonly cellBits: Uint32Array;
  /** What of this a view may show, and what may be seen through open doors; without a view in all directions. Mirrors are not followed. */
  narrow(view?: View | null, options?: NarrowOptions): Narrowed;
}

/** What of a place a view shows. */
export interface Narrowed extends Visible {
  /** The method that answered: the exact one leaves what takes it too long to that of the incident portals. */
  readonly method: Method;
}

/** Which doors are shut, and which portals are closed on their own account. By the number of a door, or by a name for all doors of this name. */
export interface Doors {
  close(door: number | string): this;
  /** Portals that another shut door closes stay closed. */
  open(door: number | string): this;
  isShut(door: number | string): boolean;
  closePortal(portal: number): this;
  openPortal(portal: number): this;
  openAll(): this;
  /** Whether a portal can not be passed. */
  isClosed(portal: number): boolean;
}

/** What changed. */
export class VisibilityEvent extends Event {
  readonly place: Place;
  /** The objects that may be seen from now on. */
  readonly gained: number[];
  /** Those that no longer may. */
  readonly lost: number[];
}

/** Follows an eye. Its event `change` tells what may be seen from now on, and what no longer. */
export interface Watch extends EventTarget {
  /** Where the eye was last. */
  readonly place: Place | null;
  /** The eye is at a point now. Whether what may be seen has changed. */
  update(eye: Point): boolean;
  addEventListener(type: "change", listener: (event: VisibilityEvent) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject | null, options?: boolean | AddEventListenerOptions): void;
}

/** A table of visibility, plain or packed. */
export class Table {
  private constructor();
  /** Reads the bytes of a file. Throws a TableError if anything is wrong with them. */
  static read(bytes: ArrayBuffer | ArrayBufferView): Table;
  /** 2 in a plane, 3 in space. */
  readonly dimension: 2 | 3;
  readonly cells: readonly Cell[];
  readonly portals: readonly Portal[];
  readonly objects: readonly Item[];
  readonly doors: readonly Door[];
  /** For each cell the objects that touch it. */
  readonly cellObjects: readonly Uint32Array[];
  /** The axis that points up, 0 to 2; -1 if it is not known. */
  readonly up: number;
  /** The axes of the table, if they are not those of the scene, and how far its coordinates may be from the scene's. */
  readonly frame: { readonly axes: readonly (readonly number[])[]; readonly gap: number } | null;
  /** Whether points can be located at all; without, everything is outside. */
  readonly hasPlaces: boolean;
  /** Keys and values, for people. */
  readonly info: readonly (readonly [string, string])[];
  /** What may be seen from a point of the scene. */
  at(point: Point): Place;
  /** The objects that may be seen from a point, or of those the ones that a view may show. */
  visibleItems(eye: Point, view?: View | null, options?: NarrowOptions): Item[];
  /** The objects of a name; names may repeat. */
  named(name: string): readonly number[];
  /** All doors, open. */
  openDoors(): Doors;
  /**
   * A lower bound of the seconds until bodies at two points may see each other, if they are no faster than these speeds in scene units a second, straight
   * ahead. Without speeds, of the way that each has to go. 0 if they may see each other now, or one is outside of all cells.
   */
  timeToSight(a: Point, b: Point, speeds?: readonly [number, number]): number;
  /** Tells when what may be seen from an eye changes. At first nothing is seen, unless it is said to be everything. */
  watch(options?: { readonly from?: "nothing" | "everything" }): Watch;
  /** A point of the scene along the axes of the table. */
  toTable(point: readonly number[]): number[];
  /** A point along the axes of the table as one of the scene. */
  toScene(point: readonly number[]): number[];
}

/** Reads a table from bytes, from a Blob or a Response, or from an address. */
export function load(source: string | URL | Request | Response | Blob | ArrayBuffer | ArrayBufferView, init?: RequestInit): Promise<Table>;
