// Complex numbers, as the document has them too.

export interface Complex {
  re: number;
  im: number;
}
