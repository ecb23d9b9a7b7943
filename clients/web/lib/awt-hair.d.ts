// Types of awt-hair.js.
import type { Object3D, Scene } from 'three';

/** Metres, +Y up, the face looks along +Z; the quaternion (x y z w) turns head or body coordinates into the world's. */
export interface Pose { position: [number, number, number]; orientation: [number, number, number, number]; }
export type State = 'connecting' | 'empty' | 'busy' | 'live' | 'lost';
export type Kind = 'guides' | 'strands';
export type Level = 'full' | 'fifth' | 'guides';

/** CREATE's fields (proto/PROTOCOL.md); `file`: strands of one's own (.hair, .tfx) instead of a style. */
export interface Recipe {
  style?: string; strands?: number; seed?: number | bigint; params?: Record<string, number>;
  head?: Pose; body?: Pose; time_us?: number | bigint; file?: Uint8Array; name?: string; [field: string]: unknown;
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
export interface Shown { forest: string; token: string; driven: boolean; about: unknown; }

export interface LightSettings {
  key: { direction: number[]; colour: number[] }; rim: { direction: number[]; colour: number[] }; sky: number[];
}
export declare const DEFAULT_LIGHT: LightSettings;

/** An ERROR of the daemon; `code` is a name of proto/errors.def. */
export declare class AwtError extends Error { code: string; retry: boolean; retryAfterMs: number; }

/** Events: 'state' { state, reason, share }, 'forest' Forest, 'frame' Stats, 'nodes', 'shown' Shown | null, 'body' number[7],
 * 'refused' Error, 'open' { server }, 'between' (what is seen has gone on between two frames: draw anew). */
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
  /** Lock-step: poses of that time, and the hair there. False: the step before has not been answered, or nothing can be driven. */
  step(time_us: number | bigint, head: Pose, body?: Pose, teleport?: boolean): Promise<boolean>;
  setParams(params: Record<string, number>): Promise<unknown>;
  listStyles(): Promise<{ styles: Array<Record<string, unknown>>; params: Array<Record<string, unknown>> }>;
  show(about?: unknown): void;
  takeWheel(): void;
  sayBody(body: Pose): void;
  destroy(handle?: bigint): Promise<unknown>;
  dispose(): void;
}
