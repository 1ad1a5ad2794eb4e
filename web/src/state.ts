// What the reader has chosen; sections listen.

import { firstMode, type Mode, type PoseReport, type Report } from './document';

export type Change = 'pose' | 'mode' | 'theme';
type Listener = (change: Change) => void;

export class State {
  private listeners: Listener[] = [];
  private poseIndex = 0;
  private modeNumber: number;

  constructor(readonly report: Report) {
    this.modeNumber = this.pose ? firstMode(report, this.pose) : 1;
  }

  get pose(): PoseReport {
    return this.report.poses[this.poseIndex] as PoseReport;
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
