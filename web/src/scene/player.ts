// Moves two machines in a mode and its rigid counterpart, at one phase.

import type { PoseReport } from '../document';
import {
  alignment,
  largest,
  pointsAt,
  restShape,
  shapeOf,
  sizeOf,
  type AtRest,
  type ModeShape,
  type Shape,
} from './motion';
import type { Side, View } from './view';

/** Least MAC of two modes that are shown as counterparts. */
export const comparable = 0.1;

/** A pose of the report, or a machine that was measured there. */
export interface MovingPose extends AtRest {
  model: PoseReport['model'];
  rigid_modes: ModeShape[];
}

/** A mode, and its counterpart in `rigid_modes`, counted from 1. */
export type MovingMode = ModeShape & { rigid?: { mode: number; mac: number } };

export class Player {
  playing = true;
  phase = 0;
  /** Largest displacement as a share of the machine's size. */
  relativeAmplitude = 0.12;
  /** Periods shown per second. */
  speed = 0.5;
  tilt = 1;
  frames = 0;
  private flexible: Shape | null = null;
  private rigid: Shape | null = null;
  private amplitude = 0;
  private rigidAmplitude = 0;
  private sides: Side[] = [];
  private mode: MovingMode | null = null;
  private pose: MovingPose | null = null;
  private last = 0;
  private scheduled = false;
  /** Something changed since it was drawn last. */
  private stale = false;
  visible = true;

  /** Told when it begins or stops to play. */
  onPlaying: (playing: boolean) => void = () => {};

  constructor(private readonly view: View) {}

  show(pose: MovingPose, mode: MovingMode): void {
    const changed = pose !== this.pose;
    this.pose = pose;
    this.mode = mode;
    this.sides = pose.model === 'rigid' ? ['rigid'] : ['flexible', 'rigid'];
    if (changed) this.view.setMachine(pose.geometry, this.sides);
    this.shape();
    if (changed)
      for (const side of this.sides) this.view.setPoints(side, pointsAt(this.shapeAt(side), 0, 0));
    this.refresh();
  }

  /** After a change of amplitude or of the factor on the rod tilt. */
  reshape(): void {
    this.shape();
    this.refresh();
  }

  private shape(): void {
    const { pose, mode } = this;
    if (!pose || !mode) return;
    const wanted = this.relativeAmplitude * sizeOf(pose.geometry);
    const own = shapeOf(pose, mode, this.tilt);
    // the factor must not reduce the rest of the motion
    this.amplitude = wanted / Math.max(largest(shapeOf(pose, mode)), Number.MIN_VALUE);
    if (pose.model === 'rigid') {
      [this.rigid, this.rigidAmplitude] = [own, this.amplitude];
      return;
    }
    this.flexible = own;
    const counterpart =
      mode.rigid && mode.rigid.mac >= comparable
        ? pose.rigid_modes[mode.rigid.mode - 1]
        : undefined;
    this.rigid = counterpart ? shapeOf(pose, counterpart) : restShape(pose);
    const joints = largest(own, ['joint']);
    const rigidJoints = largest(this.rigid, ['joint']);
    this.rigidAmplitude =
      rigidJoints > 0 ? (alignment(this.rigid, own) * this.amplitude * joints) / rigidJoints : 0;
  }

  private shapeAt(side: Side): Shape {
    return (side === 'flexible' ? this.flexible : this.rigid) as Shape;
  }

  motion() {
    const { amplitude, rigidAmplitude, phase, tilt, playing } = this;
    return { amplitude, rigidAmplitude, phase, tilt, playing };
  }

  setPlaying(playing: boolean): void {
    this.playing = playing;
    this.onPlaying(playing);
    this.last = 0;
    this.refresh();
  }

  setPhase(phase: number): void {
    this.playing = false;
    this.onPlaying(false);
    this.phase = phase;
    this.draw();
  }

  /** Draws at the next frame, and goes on while it plays and can be seen. */
  refresh(): void {
    this.stale = true;
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((time) => {
      this.scheduled = false;
      this.advance(time);
      if (this.stale) this.draw();
      if (this.playing && this.visible) this.refresh();
    });
  }

  private advance(time: number): void {
    if (this.playing && this.last > 0) {
      const seconds = Math.min(0.1, (time - this.last) / 1000);
      this.phase = (this.phase + 2 * Math.PI * this.speed * seconds) % (2 * Math.PI);
    }
    this.last = this.playing ? time : 0;
  }

  private draw(): void {
    this.stale = false;
    for (const side of this.sides) {
      const amplitude = side === 'flexible' ? this.amplitude : this.rigidAmplitude;
      this.view.setPoints(side, pointsAt(this.shapeAt(side), amplitude, this.phase));
    }
    this.view.draw();
    ++this.frames;
    window.hydrapod.firstFrame ??= performance.now();
  }
}
