// What is dragged stays under the pointer, whatever grows and shrinks above it.

/** What a reader does to scroll. */
const scrolling = ['wheel', 'keydown', 'pointerdown'];

/**
 * Keeps `element` where it is in the window, as heights of `sections` change, until the reader scrolls or
 * presses something. The browser's own scroll anchoring comes a frame later, and not always.
 */
export function keepInPlace(element: Element, sections: Iterable<Element>): void {
  const top = () => element.getBoundingClientRect().top;
  const begin = top();
  const heights = new ResizeObserver(() => scrollBy({ top: top() - begin, behavior: 'instant' }));
  for (const section of sections) heights.observe(section);
  document.documentElement.classList.add('in-place');
  const end = () => {
    heights.disconnect();
    document.documentElement.classList.remove('in-place');
    for (const kind of scrolling) removeEventListener(kind, end, { capture: true });
  };
  for (const kind of scrolling) addEventListener(kind, end, { capture: true, passive: true });
}
