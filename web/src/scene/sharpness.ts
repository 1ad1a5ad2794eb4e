// Pictures that move are as sharp as 30 frames a second allow; those that stand are sharp.

/** Longest time between frames [ms] of a motion that looks smooth, and what a frame should take. */
const [slow, wanted] = [36, 26];
/** Where frames are no further apart [ms], there is room for more pixels. */
const fast = 20;
const finer = 1.3;
/** Least pixels per pixel of the screen, along one side. */
const coarsest = 0.3;
/** Frames further apart [ms] are not of one motion. */
const still = 600;
/** Frames that are looked at before the sharpness changes. */
const watched = 6;

export class Sharpness {
  private share = 1;
  private last = -Infinity;
  /** Times since the frame before [ms], of those at this sharpness. */
  private times: number[] = [];
  private rest: ReturnType<typeof setTimeout> | undefined;
  /** Fast looks in a row; as many as are needed before the picture becomes finer, which doubles each time in vain. */
  private quick = 0;
  private patience = 3;
  private tried = false;

  /** `redraw`: asks for a frame, which is then sharp. */
  constructor(private readonly redraw: () => void) {}

  /** Pixels per pixel of the screen of a frame at the time `now` [ms]. */
  ofFrame(now: number): number {
    const since = now - this.last;
    this.last = now;
    clearTimeout(this.rest);
    if (since > still) {
      this.times = [];
      return 1;
    }
    this.times.push(since);
    if (this.times.length === watched) this.adapt();
    if (this.share < 1) this.rest = setTimeout(this.redraw, still + 50);
    return this.share;
  }

  private adapt(): void {
    const median = [...this.times].sort((a, b) => a - b)[watched >> 1];
    this.times = [];
    this.quick = median <= fast ? this.quick + 1 : 0;
    if (median > slow) {
      // the time goes with the number of pixels, at most
      this.share = Math.max(coarsest, this.share * Math.max(0.5, Math.sqrt(wanted / median)));
      if (this.tried) this.patience *= 2;
    } else if (this.share < 1 && this.quick >= this.patience) {
      this.share = Math.min(1, this.share * finer);
      this.quick = 0;
      this.tried = true;
      return;
    }
    this.tried = false;
  }
}
