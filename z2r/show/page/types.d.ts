// What the script of a page is given, for the type check of page.js; nothing of it is in the page. The data are made
// by script_data.py, the elements by the templates.

/** A column, one value for each frame: float32, or float64 where the data need it. What both can do. */
interface Values {
  readonly length: number;
  readonly [frame: number]: number;
  at(frame: number): number | undefined;
  filter(keep: (value: number) => boolean): Values;
  reduce(combine: (one: number, other: number) => number, first: number): number;
  subarray(from: number, to: number): Values;
  [Symbol.iterator](): Iterator<number>;
}

/** Least and greatest value of a chart, or of what a goal allows; null where there is none, or it is no number. */
type Ends = [number | null, number | null];
type Kind = "measured" | "command";
type Severity = "error" | "warning" | "note";

interface PageData {
  /** Frames a second. */
  fps: number;
  /** Of a longer path, so many frames are drawn. */
  longestPath: number;
  /** How many frames the page holds, and how many the dataset has. */
  shown: number;
  total: number;
  /** Feature and dimension of the columns that come first. */
  names: [string, string][];
  /** Column after column in base64, and how many bytes a value takes. */
  frames: string;
  bytes: number;
  /** The right one first. */
  readings: Reading[];
  charts: Chart[];
  cameras: Film[];
  findings: Finding[];
}

interface Reading {
  name: string;
  /** First frame, and one past the last, of each episode whose beginning the page holds; and their numbers. */
  episodes: [number, number][];
  numbers: number[];
  goals: Goal[];
  /** Of each pose the columns of x, y and the yaw [rad]. */
  poses: Record<string, [number, number, number | null]>;
  /** How the yaw of a pose is decoded. */
  formulas: Record<string, string>;
  action?: Action | null;
  /** Of each episode, whether it reached its goal, and whether the dataset calls it a success. */
  reached?: boolean[];
  stored?: boolean[];
  /** How many reached, in words. */
  said?: string;
}

interface Goal {
  name: string;
  label: string;
  unit: string;
  column: number;
  /** A bit for each frame, in base64: whether the goal holds. */
  held: string;
  limit: string;
  band: Ends | null;
  isAngle: boolean;
}

/** Where the action would bring a body in one frame: a place, or else a change once it is scaled. */
interface Action {
  pose: string;
  columns: number[];
  scale: number;
  isPlace: boolean;
}

interface Chart {
  group: string;
  name: string;
  unit: string;
  series: Partial<Record<Kind, number>>;
  /** In the whole dataset. */
  ends: Ends;
}

interface Film {
  /** An mp4 in base64, when its first frame is shown [s], and of how many frames it has the pictures. */
  clips: [string, number, number][];
  /** Instead, frames counted over the page, each with an image in base64 and its media type. */
  pictures: [number, string, string][];
  /** Why there is none of the other episodes. */
  missing: string;
}

interface Finding {
  severity: Severity;
  episodes: number[];
  /** Whose traces it marks; null for all, where it is about the whole frame. */
  columns: number[] | null;
  /** The frame, counted from the first that the page holds. */
  at: number | null;
}

/** What the templates give an id. */
interface Ids {
  clock: HTMLElement;
  data: HTMLScriptElement;
  episode: HTMLSelectElement;
  fewer: HTMLButtonElement;
  filter: HTMLSelectElement;
  frame: HTMLInputElement;
  more: HTMLButtonElement;
  next: HTMLButtonElement;
  pager: HTMLElement;
  play: HTMLButtonElement;
  player: HTMLElement;
  plots: HTMLElement;
  previous: HTMLButtonElement;
  said: HTMLElement;
  scale: HTMLFieldSetElement;
  scene: SVGSVGElement | null;
  speed: HTMLSelectElement;
  switch: HTMLDetailsElement;
  transport: HTMLElement;
  verdict: HTMLElement;
  which: HTMLElement;
}
