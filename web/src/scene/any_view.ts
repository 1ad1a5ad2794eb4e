// A picture of machines: in 3D, or flat where there is no WebGL.

import { SvgView } from './svg_view';
import type { View } from './view';
import { WebglView } from './webgl_view';

export function anyView(onChange: () => void): View {
  try {
    return new WebglView(onChange);
  } catch {
    return new SvgView();
  }
}
