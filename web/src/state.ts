// What the reader has chosen; sections listen.

import { firstMode, type Mode, type PoseReport, type Report } from './document';

export type Change = 'pose' | 'numbers' | 'mode' | 'theme';
type Listener = (change: Change) => void;

export class State {
  private listeners: Listener[] = [];
  private poseIndex = 0;
  private modeNumber: number;
  /** Gets the changed values [SI] and the arguments of `--set`, shortly after the last change. */
  onValues: ((values: [string, number][], assignments: string[]) => void) | null = null;
  /** The pose of a machine with other numbers. */
  private other: PoseReport | null = null;

  constructor(readonly report: Report) {
    this.modeNumber = this.pose ? firstMode(report, this.pose) : 1;
  }

  get pose(): PoseReport {
    return this.other ?? this.stated;
  }

  /** The pose of the machine that the report is about. */
  get stated(): PoseReport {
    return this.report.poses[this.poseIndex] as PoseReport;
  }

  /** Is what is shown of a machine with other numbers? */
  get isWhatIf(): boolean {
    return this.other !== null;
  }

  /** Shows this pose of a machine with other numbers; null: the report's own. */
  showOther(pose: PoseReport | null): void {
    if (pose === this.other) return;
    this.other = pose;
    this.tell('numbers');
  }

  get poseNumber(): number {
    return this.poseIndex;
  }

  get mode(): Mode {
    const { modes } = this.pose;
    return modes.find((mode) => mode.number === this.modeNumber) ?? (modes[0] as Mode);
  }

  choosePose(index: number): void {
    this.poseIndex = index;
    this.other = null;
    this.tell('pose');
  }

  chooseMode(number: number): void {
    this.modeNumber = number;
    this.tell('mode');
  }

  listen(listener: Listener): void {
    this.listeners.push(listener);
  }

  tell(change: Change): void {
    for (const listener of this.listeners) listener(change);
  }
}
