// Both machines in one WebGL canvas: two viewports beside each other, or below each other where it
// is narrow, seen by one camera.

import {
  AmbientLight,
  Color,
  DirectionalLight,
  HemisphereLight,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Geometry } from '../document';
import { html } from '../dom';
import type { LegPoints, MachinePoints } from './motion';
import { palette } from '../palette';
import { Machine3D } from './machine3d';
import { Sharpness } from './sharpness';
import { homeCamera, sizesOf, type Side, type View } from './view';

/** Vertical field of view [°] at which the whole machine is seen at the usual distance, in width and in height. */
function fieldOfView(aspect: number): number {
  const [width, height] = [Math.tan(0.253), Math.tan(0.267)]; // half of it, per distance
  return (2 * Math.atan(Math.max(height, width / aspect)) * 180) / Math.PI;
}

interface Stage {
  scene: Scene;
  machine: Machine3D;
  rest: MachinePoints;
  points: MachinePoints;
}

export class WebglView implements View {
  readonly kind = 'webgl';
  readonly element: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(26, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly stages = new Map<Side, Stage>();
  private geometry: Geometry | null = null;
  private sides: Side[] = [];
  private labels = true;
  /** Of the canvas when it was drawn last [px]; pixels of the screen per pixel. */
  private drawn = { width: 0, height: 0, ratio: 0 };
  private readonly sharpness: Sharpness;

  /** Throws where there is no WebGL. */
  constructor(onChange: () => void) {
    this.canvas = html('canvas', { class: 'machine', tabindex: 0, role: 'img' });
    this.element = this.canvas;
    const context = this.canvas.getContext('webgl2', { antialias: true, alpha: true });
    if (!context) throw new Error('no WebGL');
    this.renderer = new WebGLRenderer({ canvas: this.canvas, context, alpha: true });
    this.sharpness = new Sharpness(onChange);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enablePan = false;
    this.controls.enableZoom = false; // the wheel scrolls the page until the picture was clicked
    this.canvas.style.touchAction = 'pan-y';
    this.canvas.addEventListener('focus', () => (this.controls.enableZoom = true));
    this.canvas.addEventListener('blur', () => (this.controls.enableZoom = false));
    this.controls.addEventListener('change', onChange);
    new ResizeObserver(() => this.resized() && onChange()).observe(this.canvas);
  }

  setMachine(geometry: Geometry, sides: Side[]): void {
    const first = this.geometry === null;
    this.geometry = geometry;
    this.sides = sides;
    for (const stage of this.stages.values()) stage.machine.dispose();
    this.stages.clear();
    if (first) this.resetCamera();
  }

  setPoints(side: Side, points: MachinePoints): void {
    if (!this.geometry) return;
    const stage = this.stages.get(side);
    if (!stage) {
      // the first points of a machine are those at rest
      this.stages.set(side, this.stage(this.geometry, points));
    } else {
      stage.points = points;
      stage.machine.place(points);
    }
  }

  private stage(geometry: Geometry, rest: MachinePoints): Stage {
    const scene = new Scene();
    const machine = new Machine3D(geometry, rest, palette());
    machine.setLabels(this.labels);
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(-1, -2, 3);
    const sky = new HemisphereLight(0xffffff, new Color(0x667788), 1.5);
    sky.position.set(0, 0, 1);
    scene.add(machine.group, sun, sky, new AmbientLight(0xffffff, 0.4));
    return { scene, machine, rest, points: rest };
  }

  readPoints(side: Side, leg: number): LegPoints {
    return this.stages.get(side)!.machine.read(leg);
  }

  recolour(): void {
    for (const [side, old] of this.stages) {
      const stage = this.stage(this.geometry!, old.rest);
      stage.machine.place(old.points);
      old.machine.dispose();
      this.stages.set(side, { ...stage, points: old.points });
    }
  }

  setLabels(shown: boolean): void {
    this.labels = shown;
    for (const stage of this.stages.values()) stage.machine.setLabels(shown);
  }

  resetCamera(): void {
    this.lookFrom(homeCamera.azimuth, homeCamera.elevation, homeCamera.distance);
  }

  orbit(azimuth: number, elevation: number, zoom: number): void {
    const arm = this.camera.position.clone().sub(this.controls.target);
    const limit = 1.5;
    const now = Math.asin(arm.z / arm.length());
    this.lookFrom(
      Math.atan2(arm.y, arm.x) + azimuth,
      Math.max(-limit, Math.min(limit, now + elevation)),
      arm.length() / sizesOf(this.geometry!).radius / zoom,
    );
  }

  private lookFrom(azimuth: number, elevation: number, distance: number): void {
    const { target, radius } = sizesOf(this.geometry!);
    const r = distance * radius;
    this.controls.target.set(...target);
    this.camera.position
      .set(
        Math.cos(elevation) * Math.cos(azimuth),
        Math.cos(elevation) * Math.sin(azimuth),
        Math.sin(elevation),
      )
      .multiplyScalar(r)
      .add(new Vector3(...target));
    this.camera.near = 0.05 * radius;
    this.camera.far = 40 * radius;
    this.controls.minDistance = 1.5 * radius;
    this.controls.maxDistance = 15 * radius;
    this.controls.update();
  }

  private resized(): boolean {
    const { clientWidth, clientHeight } = this.canvas;
    return clientWidth !== this.drawn.width || clientHeight !== this.drawn.height;
  }

  draw(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const seen = width > 0 && height > 0;
    const ratio = Math.min(devicePixelRatio, 2) * this.sharpness.ofFrame(performance.now());
    // to set a size, even the same one, makes the picture's memory anew
    if (seen && ratio !== this.drawn.ratio) this.renderer.setPixelRatio(ratio);
    if (seen && this.resized()) this.renderer.setSize(width, height, false);
    this.drawn = { width, height, ratio };
    if (!seen) return;
    this.renderer.setScissorTest(true);
    const stacked = this.sides.length > 1 && width < height * 1.1;
    const count = this.sides.length;
    this.sides.forEach((side, i) => {
      const stage = this.stages.get(side);
      if (!stage) return;
      const w = stacked ? width : width / count;
      const h = stacked ? height / count : height;
      const x = stacked ? 0 : i * w;
      const y = stacked ? height - (i + 1) * h : 0; // counted from below
      this.renderer.setViewport(x, y, w, h);
      this.renderer.setScissor(x, y, w, h);
      this.camera.aspect = w / h;
      this.camera.fov = fieldOfView(w / h);
      this.camera.updateProjectionMatrix();
      this.renderer.render(stage.scene, this.camera);
    });
  }
}
