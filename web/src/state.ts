// What the reader has chosen; sections listen.

import { firstMode, type Mode, type PoseReport, type Report } from './document';

export type Change = 'pose' | 'numbers' | 'mode' | 'theme' | 'displaced';
type Listener = (change: Change) => void;

export class State {
  private listeners: Listener[] = [];
  private poseIndex = 0;
  private modeNumber: number;
  /** Gets the changed values [SI] and the arguments of `--set`, shortly after the last change. */
  onValues: ((values: [string, number][], assignments: string[]) => void) | null = null;
  /** Displacement from the neutral pose at which the machine is shown [m, rad]; null: the chosen pose. */
  private displacement: number[] | null = null;
  /** Changed values of the machine that is shown [SI]. */
  values: [string, number][] = [];
  /** The same in words: "platform.mass 9000 kg (report: 1000 kg)". */
  changes: string[] = [];
  /** The pose of a machine with other numbers, or at another place. */
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

  get displaced(): number[] | null {
    return this.displacement;
  }

  /** Shows the machine at this displacement once somebody has calculated it. */
  displace(displacement: number[] | null): void {
    this.displacement = displacement;
    this.tell('displaced');
  }

  /** Is what is shown of a machine with other numbers, or at a pose that the report does not have? */
  get isWhatIf(): boolean {
    return this.other !== null;
  }

  /** Shows this pose of a machine with other numbers; null: the report's own. */
  showOther(pose: PoseReport | null): void {
    if (pose === this.other) return;
    this.other = pose;
    this.tell('numbers');
  }

  /** "with 2 changed values"; empty: as the report has them. */
  get changedWords(): string {
    const { length } = this.isWhatIf ? this.values : [];
    return length === 0 ? '' : `with ${length} changed value${length === 1 ? '' : 's'}`;
  }

  /** "pose low"; empty where there is no other pose. */
  get poseWords(): string {
    const named = this.report.poses.length > 1 || (this.isWhatIf && this.displacement);
    return named ? `pose ${this.pose.pose.name}` : '';
  }

  /** What sections say on paper: "pose low, with 2 changed values"; empty where there is nothing else. */
  get shownWords(): string {
    return [this.poseWords, this.changedWords].filter(Boolean).join(', ');
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
    this.displacement = null;
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
