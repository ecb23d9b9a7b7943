// Types of awt-hair.js.
import type { Object3D, Scene } from 'three';

/** Metres, +Y up, the face looks along +Z; the quaternion (x y z w) turns head or body coordinates into the world's. */
export interface Pose { position: [number, number, number]; orientation: [number, number, number, number]; }
export type State = 'connecting' | 'empty' | 'busy' | 'live' | 'lost';
export type Kind = 'guides' | 'strands';
export type Level = 'full' | 'fifth' | 'guides';

/** 'lockstep' (how every forest begins): step brings it from time to time. 'free': simulated time goes with the daemon's clock,
 * `rate` simulated seconds a second (0.01 to 10), whether anybody drives or not; move says where the head is. 'paused': it stands still. */
export type Mode = 'lockstep' | 'free' | 'paused';

/** How a forest's time goes: it was simulated time `time_us` when the daemon's clock was `clock_us`, both microseconds; null where
 * somebody else set it. Never changed, only replaced. */
export interface Clock { readonly mode: Mode; readonly rate: number; readonly time_us: bigint | null; readonly clock_us: bigint | null; }

/** CREATE's fields (proto/PROTOCOL.md); `file`: strands of one's own (.hair, .tfx) instead of a style; `clock`: how time goes, if
 * not in lock-step. */
export interface Recipe {
  style?: string; strands?: number; seed?: number | bigint; params?: Record<string, number>;
  head?: Pose; body?: Pose; time_us?: number | bigint; file?: Uint8Array; name?: string;
  clock?: { mode: Mode; rate?: number } | null; [field: string]: unknown;
}

export interface Forest {
  handle: bigint; mayDrive: boolean; time_us: bigint; strands: number; points_per_strand: number;
  /** Of a forest made here: what others need to open it, and its obstacles. */
  driveToken?: string; viewToken?: string; colliders: null | Array<Record<string, number>>;
}

/** Of the last frame. */
export interface Stats {
  strands: number; points: number; frames: number; bytes: number; active: number; splits: number; merges: number; step_ms: number;
  encode_ms: number; age_ms: number; delta: boolean; time_us: bigint; sequence: bigint; skipped: number; energy: number;
}

/** What the gateway's driving page shows. */
export interface Shown { forest: string; token: string; driven: boolean; about: unknown; clock: { mode: Mode; rate: number } | null; }

export interface LightSettings {
  key: { direction: number[]; colour: number[] }; rim: { direction: number[]; colour: number[] }; sky: number[];
}
export declare const DEFAULT_LIGHT: LightSettings;

/** An ERROR of the daemon; `code` is a name of proto/errors.def. */
export declare class AwtError extends Error { code: string; retry: boolean; retryAfterMs: number; }

/** Events: 'state' { state, reason, share }, 'forest' Forest, 'frame' Stats, 'nodes', 'shown' Shown | null, 'body' number[7],
 * 'clock' Clock | null, 'refused' Error, 'open' { server }, 'between' (what is seen has gone on between two frames: draw anew). */
export declare class AwtHair extends EventTarget {
  /** `url`: of the gateway, e.g. ws://127.0.0.1:8080/awt; `token`: 32 hexadecimal digits, to view or to drive. */
  constructor(url: string, token: string, scene: Scene | null, options?: { kind?: Kind; level?: Level; nodes?: boolean });
  /** In the scene; has the head's pose. */
  readonly object: Object3D;
  readonly state: State;
  readonly reason: string;
  readonly forest: Forest | null;
  readonly stats: Stats;
  readonly shown: Shown | null;
  /** What the token is for; null until the gateway has said so. */
  readonly scope: 'drive' | 'view' | null;
  /** Of a page that drives: what others may look on with. */
  readonly viewToken: string | null;
  create(recipe: Recipe): Promise<Forest | null>;
  attach(forest: bigint | string, token: string): Promise<Forest | null>;
  /** Back to what the gateway shows. */
  release(): void;
  choose(what: { kind?: Kind; level?: Level; nodes?: boolean }): Promise<void>;
  /** Null: not known. The daemon does not tell: it is known of a forest made here, where setClock was said here, and of the forest
   * that the gateway shows. Of a forest that is opened again after a loss, setClock is said again by itself; a page that follows
   * the gateway's does that with takeWheel. Where another program sets the clock, steps fail, and it is null from then on. */
  readonly clock: Clock | null;
  /** Simulated time now, microseconds; null: not known. */
  readonly now_us: bigint | null;
  /** Rejects with AwtError where it is refused: nothing has changed then. `rate`: as it is, 1 at first; `importance`: when the
   * daemon has too much to do, 0.001 to 1000. */
  setClock(wish: { mode: Mode; rate?: number; importance?: number }): Promise<Clock>;
  /** Lock-step: poses of that time, and the hair there. False: the step before has not been answered, nothing can be driven, or
   * time does not go in lock-step. */
  step(time_us: number | bigint, head: Pose, body?: Pose, teleport?: boolean): Promise<boolean>;
  /** Free-running: head and body are so now; best before each picture. Returns the simulated time that this pose is for, later
   * than the last one's; null: nothing was sent, for time does not go freely (setClock), or nothing can be driven. */
  move(head: Pose, body?: Pose, teleport?: boolean): bigint | null;
  setParams(params: Record<string, number>): Promise<unknown>;
  listStyles(): Promise<{ styles: Array<Record<string, unknown>>; params: Array<Record<string, unknown>> }>;
  show(about?: unknown): void;
  takeWheel(): Promise<Clock>;
  sayBody(body: Pose): void;
  destroy(handle?: bigint): Promise<unknown>;
  dispose(): void;
}
