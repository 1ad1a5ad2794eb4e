// Colours that the colour-blind can tell apart (after Okabe and Ito, and Tol), with line styles
// besides. Those of pages stand in style/colours.css; these are for canvases and pictures.

export interface Palette {
  text: string;
  faint: string;
  grid: string;
  background: string;
  flexible: string;
  rigid: string;
  case: string;
  rod: string;
  sleeve: string;
  piston: string;
  platform: string;
  base: string;
  ghost: string;
}

export const light: Palette = {
  text: '#1b2430',
  faint: '#56616e',
  grid: '#dfe4ea',
  background: '#ffffff',
  flexible: '#0072b2',
  rigid: '#b5530a',
  case: '#5b6b7d',
  rod: '#8b97a5',
  sleeve: '#d55e00',
  piston: '#c79a00',
  platform: '#3b7fb5',
  base: '#b4bbc4',
  ghost: '#a9b2bd',
};

export const dark: Palette = {
  text: '#e4e9f0',
  faint: '#a3afbd',
  grid: '#2f3947',
  background: '#161c25',
  flexible: '#56b4e9',
  rigid: '#f0a04b',
  case: '#8394a8',
  rod: '#c3ccd6',
  sleeve: '#ff7f2a',
  piston: '#f0d060',
  platform: '#56a5dd',
  base: '#465060',
  ghost: '#5a6675',
};

export type Theme = 'auto' | 'light' | 'dark';

export const theme = (): Theme => (document.documentElement.dataset['theme'] ?? 'auto') as Theme;

const systemIsDark = matchMedia('(prefers-color-scheme: dark)');

let onPaper = false;

/** Paper is light. Returns whether this changes the colours. */
export function setPaper(paper: boolean): boolean {
  const before = isDark();
  onPaper = paper;
  return isDark() !== before;
}

export function isDark(): boolean {
  if (onPaper) return false;
  return theme() === 'dark' || (theme() === 'auto' && systemIsDark.matches);
}

export const palette = (): Palette => (isDark() ? dark : light);

export function onSystemTheme(listener: () => void): void {
  systemIsDark.addEventListener('change', listener);
}

/** How the axes of all diagrams look. */
export function axisStyle(colours: Palette) {
  const font = '12px system-ui, sans-serif';
  return {
    stroke: colours.faint,
    font,
    labelFont: font,
    grid: { stroke: colours.grid, width: 1 },
    ticks: { stroke: colours.grid, width: 1 },
  };
}
