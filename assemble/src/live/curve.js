// Error bound and residual against seconds, both axes logarithmic. Input: points of rounds. Output: a drawing.

const MARGIN = { left: 40, right: 8, top: 6, bottom: 18 };

export class Curve {
  constructor(canvas) {
    this.canvas = canvas;
    this.points = [];
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  // `points` in order, and the newest point, which may not be among them.
  set(points, now) {
    this.points = now && points.at(-1)?.seconds !== now.seconds ? [...points, now] : points;
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width) return;
    const scale = devicePixelRatio;
    [this.canvas.width, this.canvas.height] = [width * scale, height * scale];
    const pen = this.canvas.getContext("2d");
    pen.scale(scale, scale);
    pen.font = "10px system-ui, sans-serif";
    const style = getComputedStyle(this.canvas);
    const colour = (name) => style.getPropertyValue(name);
    const values = this.points.flatMap((point) => [point.bound, point.residual]).filter((value) => value > 0 && isFinite(value));
    const times = this.points.map((point) => point.seconds).filter((seconds) => seconds > 0);
    if (!values.length || !times.length) {
      pen.fillStyle = colour("--quiet");
      pen.fillText("Waiting for the first round.", MARGIN.left, height / 2);
      return;
    }
    const x = axis(times, MARGIN.left, width - MARGIN.right);
    const y = axis(values, height - MARGIN.bottom, MARGIN.top);
    pen.lineWidth = 1;
    pen.strokeStyle = colour("--line");
    pen.fillStyle = colour("--quiet");
    pen.textAlign = "center";
    for (const power of x.ticks) {
      line(pen, x.at(10 ** power), MARGIN.top, x.at(10 ** power), height - MARGIN.bottom);
      pen.fillText(label(power), x.at(10 ** power), height - 4);
    }
    pen.textAlign = "right";
    for (const power of y.ticks) {
      line(pen, MARGIN.left, y.at(10 ** power), width - MARGIN.right, y.at(10 ** power));
      pen.fillText(label(power), MARGIN.left - 5, y.at(10 ** power) + 3);
    }
    pen.lineWidth = 1.5;
    for (const [name, key] of [["--cool", "residual"], ["--accent", "bound"]]) {
      pen.strokeStyle = pen.fillStyle = colour(name);
      this.path(pen, x, y, key);
    }
  }

  // Each group of parts has its own curve.
  path(pen, x, y, key) {
    let group;
    pen.beginPath();
    for (const point of this.points) {
      if (!(point[key] > 0 && isFinite(point[key]))) continue;
      const [to, up] = [x.at(point.seconds), y.at(point[key])];
      if (point.group === group) pen.lineTo(to, up);
      else pen.moveTo(to, up);
      group = point.group;
    }
    pen.stroke();
    const last = this.points.at(-1);
    if (!(last[key] > 0)) return;
    pen.beginPath();
    pen.arc(x.at(last.seconds), y.at(last[key]), 2.5, 0, 2 * Math.PI);
    pen.fill();
  }
}

// An axis over integer or half-integer powers of ten, with at most six ticks.
function axis(values, start, end) {
  const logs = values.map(Math.log10);
  const [least, most] = logs.reduce(([low, high], log) => [Math.min(low, log), Math.max(high, log)], [Infinity, -Infinity]);
  const [low, high] = [Math.floor(least), Math.max(Math.ceil(most), Math.floor(least) + 1)];
  const every = Math.ceil((high - low) / 5);
  const ticks = [];
  for (let power = low; power <= high; power += every) ticks.push(power);
  return { ticks, at: (value) => start + ((Math.log10(value) - low) / (high - low)) * (end - start) };
}

function label(power) {
  return Math.abs(power) <= 2 ? String(Number((10 ** power).toPrecision(1))) : `1e${power}`;
}

function line(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}
