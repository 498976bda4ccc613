// A camera that orbits a point. Input: pointer, wheel and keys on a canvas. Output: the camera's position.

import { Spherical, Vector3 } from "./three.module.min.js";

const TURN = 0.006; // radians for each pixel
const STEP = 0.08; // radians for each key press
const NEARER = 1.0015; // zoom factor for each pixel of the wheel

export class Orbit {
  // `changed` is called after every move.
  constructor(canvas, camera, changed) {
    Object.assign(this, { canvas, camera, changed, target: new Vector3(), place: new Spherical() });
    this.home = null; // the position for the Home key
    this.pointers = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    }
    canvas.addEventListener("pointermove", (event) => this.dragged(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(NEARER ** (event.deltaMode === 1 ? 30 * event.deltaY : event.deltaY));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => this.typed(event));
  }

  // Place the camera at `eye`, orbiting `target`; both are arrays.
  stand(eye, target) {
    this.target.fromArray(target);
    this.place.setFromVector3(new Vector3(...eye).sub(this.target));
    this.move();
  }

  // Shift by the change of the coordinate origin, an array.
  shift(by) {
    this.target.add(new Vector3(...by));
    this.move();
  }

  dragged(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const [x, y] = [event.clientX - last[0], event.clientY - last[1]];
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (others.length) {
      const apart = (at) => Math.hypot(at[0] - others[0][0], at[1] - others[0][1]);
      this.zoom(apart(last) / Math.max(apart([event.clientX, event.clientY]), 1));
      this.pan(x / 2, y / 2);
    } else if (event.buttons & 6 || event.shiftKey) {
      this.pan(x, y);
    } else {
      this.turn(-x * TURN, -y * TURN);
    }
  }

  typed(event) {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) this.pan(-40 * arrow[0], -40 * arrow[1]);
    else if (arrow) this.turn(STEP * arrow[0], STEP * arrow[1]);
    else if (event.key === "+" || event.key === "=") this.zoom(1 / 1.15);
    else if (event.key === "-") this.zoom(1.15);
    else if (event.key === "Home" && this.home) this.stand(...this.home);
    else return;
    event.preventDefault();
  }

  turn(around, up) {
    this.place.theta += around;
    this.place.phi += up;
    this.move();
  }

  zoom(by) {
    this.place.radius *= by;
    this.move();
  }

  // Pan so that the scene follows the pointer, pixels.
  pan(x, y) {
    const metres = 2 * this.place.radius * Math.tan((this.camera.fov * Math.PI) / 360) / this.canvas.clientHeight;
    const [right, up] = [0, 1].map((axis) => new Vector3().setFromMatrixColumn(this.camera.matrix, axis));
    this.target.addScaledVector(right, -x * metres).addScaledVector(up, y * metres);
    this.move();
  }

  move() {
    this.place.makeSafe();
    this.camera.position.setFromSpherical(this.place).add(this.target);
    this.camera.lookAt(this.target);
    this.camera.updateMatrix();
    this.changed();
  }
}
