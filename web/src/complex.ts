// Complex numbers, as the document has them too.

export interface Complex {
  re: number;
  im: number;
}

export const magnitude = (h: Complex): number => Math.hypot(h.re, h.im);

/** [°], −180 … 180 */
export const phase = (h: Complex): number => (Math.atan2(h.im, h.re) * 180) / Math.PI;
