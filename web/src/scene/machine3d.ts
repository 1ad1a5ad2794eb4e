// One machine in three.js: base, platform, six cylinders; positions follow from MachinePoints.

import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  CylinderGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  TorusGeometry,
  Vector3,
} from 'three';
import type { Geometry, Vector } from '../document';
import type { LegPoints, MachinePoints } from './motion';
import { add, along, cross, norm, scale, subtract, unit } from './vector';
import type { Palette } from '../palette';
import { outline, sizesOf, type Sizes } from './view';

const up = new Vector3(0, 0, 1);
const three = (v: Vector): Vector3 => new Vector3(v[0], v[1], v[2]);
const tuple = (v: Vector3): Vector => [v.x, v.y, v.z];

interface Materials {
  case: MeshLambertMaterial;
  rod: MeshLambertMaterial;
  sleeve: MeshLambertMaterial;
  piston: MeshLambertMaterial;
  gimbal: MeshLambertMaterial;
  platform: MeshLambertMaterial;
  base: MeshLambertMaterial;
  ghost: LineBasicMaterial;
}

/** A cylinder on the origin along z with height 1, so that scale.z is its length. */
function rodGeometry(radius: number, segments = 24): CylinderGeometry {
  const geometry = new CylinderGeometry(radius, radius, 1, segments);
  geometry.rotateX(Math.PI / 2);
  geometry.translate(0, 0, 0.5);
  return geometry;
}

class Leg3D {
  readonly group = new Group();
  private readonly tube: Mesh;
  private readonly rod: Mesh;
  private readonly piston: Mesh;
  private readonly sleeve: Mesh;
  private readonly passage = new Group();
  private readonly lower: Mesh;
  private readonly upper: Mesh;
  readonly label: Sprite;

  constructor(
    index: number,
    sizes: Sizes,
    materials: Materials,
    palette: Palette,
    private readonly strut = false,
  ) {
    const R = sizes.caseRadius(index);
    const r = sizes.rodRadius(index);
    this.tube = new Mesh(rodGeometry(R), materials.case);
    this.tube.renderOrder = 2;
    this.rod = new Mesh(rodGeometry(r), materials.rod);
    this.piston = new Mesh(new CylinderGeometry(0.92 * R, 0.92 * R, 0.5 * R, 24), materials.piston);
    this.piston.geometry.rotateX(Math.PI / 2);
    this.sleeve = new Mesh(new TorusGeometry(1.02 * R, 0.28 * R, 12, 28), materials.sleeve);
    this.lower = new Mesh(new SphereGeometry(1.15 * R, 20, 14), materials.gimbal);
    this.upper = new Mesh(new SphereGeometry(1.0 * R, 20, 14), materials.gimbal);
    this.label = label(String(index + 1), palette);
    this.label.scale.setScalar(0.09 * sizes.size);
    this.label.renderOrder = 9;
    for (const part of [
      this.tube,
      this.rod,
      this.piston,
      this.sleeve,
      this.lower,
      this.upper,
      this.passage,
    ])
      this.group.add(part);
    this.group.add(this.label);
    for (const part of [this.tube, this.piston, this.sleeve, this.passage]) part.visible = !strut;
  }

  place(points: LegPoints, size: number): void {
    const axis = subtract(this.strut ? points.joint : points.sleeve, points.base);
    if (!this.strut) stretch(this.tube, points.base, points.sleeve);
    stretch(this.rod, points.piston, points.joint);
    this.piston.position.copy(three(points.piston));
    this.piston.quaternion.copy(this.tube.quaternion);
    this.sleeve.position.copy(three(points.sleeve));
    this.sleeve.quaternion.copy(this.tube.quaternion);
    this.passage.position.copy(three(points.rodAtSleeve));
    this.lower.position.copy(three(points.base));
    this.upper.position.copy(three(points.joint));
    const outward = unit([points.base[0], points.base[1], 0.001]);
    this.label.position.copy(three(along(along(points.base, 0.09 * size, outward), 0.18, axis)));
  }

  read(): LegPoints {
    this.group.updateMatrixWorld(true);
    const at = (part: Group | Mesh): Vector => tuple(part.getWorldPosition(new Vector3()));
    return {
      base: at(this.lower),
      sleeve: at(this.sleeve),
      piston: at(this.piston),
      rodAtSleeve: at(this.passage),
      joint: at(this.upper),
    };
  }
}

function stretch(part: Mesh, from: Vector, to: Vector): void {
  const d = subtract(to, from);
  part.position.copy(three(from));
  part.quaternion.setFromUnitVectors(up, three(unit(d)));
  part.scale.set(1, 1, norm(d));
}

function label(text: string, palette: Palette): Sprite {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext('2d');
  if (pen) {
    pen.fillStyle = palette.background;
    pen.strokeStyle = palette.faint;
    pen.lineWidth = 3;
    pen.beginPath();
    pen.arc(32, 32, 26, 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
    pen.fillStyle = palette.text;
    pen.font = '600 36px system-ui, sans-serif';
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.fillText(text, 32, 34);
  }
  return new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), depthTest: false }));
}

/** A plate through six points that may move: top and bottom outline, filled. */
class Plate {
  readonly mesh: Mesh;
  private readonly positions: BufferAttribute;

  constructor(count: number, material: MeshLambertMaterial) {
    const geometry = new BufferGeometry();
    this.positions = new BufferAttribute(new Float32Array(3 * 6 * (4 * count)), 3);
    geometry.setAttribute('position', this.positions);
    this.mesh = new Mesh(geometry, material);
    this.mesh.frustumCulled = false;
  }

  place(corners: Vector[], thickness: Vector): void {
    const n = corners.length;
    const center = scale(1 / n, corners.reduce(add));
    const far = corners.map((p) => add(p, thickness));
    const farCenter = add(center, thickness);
    let at = 0;
    const put = (...points: Vector[]) => {
      for (const p of points) this.positions.setXYZ(at++, p[0], p[1], p[2]);
    };
    for (let i = 0; i < n; ++i) {
      const j = (i + 1) % n;
      put(center, corners[j], corners[i], farCenter, far[i], far[j]);
      put(corners[i], corners[j], far[j], corners[i], far[j], far[i]);
    }
    this.mesh.geometry.setDrawRange(0, at);
    this.positions.needsUpdate = true;
    this.mesh.geometry.computeVertexNormals();
  }
}

function materialsOf(palette: Palette): Materials {
  // `transparent` for all, so that one shader serves them: compiling takes most of the first frame
  const solid = (color: string) => new MeshLambertMaterial({ color, transparent: true });
  const clear = (color: string, opacity: number) =>
    new MeshLambertMaterial({ color, transparent: true, opacity, depthWrite: false });
  return {
    case: clear(palette.case, 0.45),
    rod: solid(palette.rod),
    sleeve: solid(palette.sleeve),
    piston: solid(palette.piston),
    gimbal: solid(palette.faint),
    platform: solid(palette.platform),
    base: solid(palette.base),
    ghost: new LineBasicMaterial({ color: palette.ghost, transparent: true, opacity: 0.7 }),
  };
}

export class Machine3D {
  readonly group = new Group();
  private readonly legs: Leg3D[];
  private readonly platform: Plate;
  private readonly base: Plate;
  private readonly center: Mesh;
  private readonly order: number[];
  private readonly feetOrder: number[];
  private readonly sizes: Sizes;
  private readonly normal: Vector;

  constructor(geometry: Geometry, rest: MachinePoints, palette: Palette) {
    const materials = materialsOf(palette);
    this.sizes = sizesOf(geometry);
    const joints = geometry.legs.map((leg) => leg.platform_joint_m);
    this.order = outline(joints, geometry.platform.origin_m);
    this.normal = geometry.platform.rotation.map((row) => row[2]) as Vector;
    this.platform = new Plate(6, materials.platform);
    this.base = new Plate(6, materials.base);
    const feet = geometry.legs.map((leg) => leg.base_joint_m);
    this.feetOrder = outline(feet, [0, 0, 0]);
    this.legs = geometry.legs.map(
      (leg, i) => new Leg3D(i, this.sizes, materials, palette, leg.strut),
    );
    this.center = new Mesh(new SphereGeometry(0.022 * this.sizes.size, 18, 12), materials.sleeve);
    this.group.add(
      this.base.mesh,
      this.platform.mesh,
      this.center,
      ghost(rest, this.order, materials.ghost),
    );
    for (const leg of this.legs) this.group.add(leg.group);
    this.place(rest);
  }

  place(points: MachinePoints): void {
    this.legs.forEach((leg, i) => leg.place(points.legs[i], this.sizes.size));
    const corners = this.order.map((i) => points.legs[i].joint);
    const normal = add(this.normal, cross(points.rotation, this.normal));
    this.platform.place(corners, scale(this.sizes.plate, normal));
    const feet = this.feetOrder.map((i) => points.legs[i].base);
    this.base.place(feet, [0, 0, -this.sizes.plate]);
    this.center.position.copy(three(add(points.center, points.displacement)));
  }

  read(leg: number): LegPoints {
    return this.legs[leg].read();
  }

  setLabels(shown: boolean): void {
    for (const leg of this.legs) leg.label.visible = shown;
  }

  dispose(): void {
    this.group.traverse((part) => {
      if (part instanceof Mesh || part instanceof LineSegments) part.geometry.dispose();
      if (part instanceof Sprite) {
        part.material.map?.dispose();
        part.material.dispose();
      }
    });
  }
}

/** Thin lines where the machine is at rest. */
function ghost(rest: MachinePoints, order: number[], material: LineBasicMaterial): LineSegments {
  const values: number[] = [];
  rest.legs.forEach((leg) => values.push(...leg.base, ...leg.joint));
  order.forEach((i, k) => {
    values.push(...rest.legs[i].joint, ...rest.legs[order[(k + 1) % 6]].joint);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(values, 3));
  return new LineSegments(geometry, material);
}
