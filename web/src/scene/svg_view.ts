// The machines as SVG drawings, where there is no WebGL.

import type { Geometry } from '../document';
import { html } from '../dom';
import type { LegPoints, MachinePoints } from './motion';
import { palette } from '../palette';
import { drawing } from './drawing';
import { homeCamera, type Camera, type Side, type View } from './view';

export class SvgView implements View {
  readonly kind = 'svg';
  readonly element = html('div', { class: 'machine flat', role: 'img' });
  private geometry: Geometry | null = null;
  private sides: Side[] = [];
  private camera: Camera = { ...homeCamera };
  private labels = true;
  private readonly rest = new Map<Side, MachinePoints>();
  private readonly points = new Map<Side, MachinePoints>();

  setMachine(geometry: Geometry, sides: Side[]): void {
    this.geometry = geometry;
    this.sides = sides;
    this.rest.clear();
    this.points.clear();
  }

  setPoints(side: Side, points: MachinePoints): void {
    if (!this.rest.has(side)) this.rest.set(side, points);
    this.points.set(side, points);
  }

  readPoints(side: Side, leg: number): LegPoints {
    return this.points.get(side)!.legs[leg];
  }

  orbit(azimuth: number, elevation: number, zoom: number): void {
    this.camera.azimuth += azimuth;
    this.camera.elevation = Math.max(-1.5, Math.min(1.5, this.camera.elevation + elevation));
    this.camera.distance /= zoom;
  }

  resetCamera(): void {
    this.camera = { ...homeCamera };
  }

  setLabels(shown: boolean): void {
    this.labels = shown;
  }

  recolour(): void {
    this.draw();
  }

  draw(): void {
    if (!this.geometry) return;
    const zoom = homeCamera.distance / this.camera.distance;
    const pictures = this.sides.map((side) => {
      const points = this.points.get(side)!;
      const picture = drawing(
        this.geometry!,
        points,
        this.rest.get(side)!,
        this.camera,
        palette(),
        {
          labels: this.labels,
          title: `${side} machine`,
        },
      ).element;
      const { x, y, width, height } = picture.viewBox.baseVal;
      picture.setAttribute('viewBox', [x, y, width, height].map((value) => value / zoom).join(' '));
      return picture;
    });
    this.element.replaceChildren(...pictures);
  }
}
