// SPDX-License-Identifier: LGPL-2.1-or-later
// Draws runs with WebGL 2, lets the reader turn them, and goes through time with the charts. Several runs stand side by
// side and share camera, time and colours. `ink` and `lightShader` are those of the pictures (picture/ink.hpp): the page
// hands them over.
"use strict";

const fieldOfView = 28 * Math.PI / 180;
const keyHeight = 76;  // [pixels] of the colour key in the picture

const surfaceVertexShader = `#version 300 es
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in float fraction;
uniform mat4 camera;
uniform float grow;  // along the normal
out vec3 at, across;
out float value;
void main() {
  at = place + grow * normal;
  across = normal;
  value = fraction;
  gl_Position = camera * vec4(at, 1);
}`;
const surfaceFragmentShader = `#version 300 es
precision highp float;
in vec3 at, across;
in float value;
uniform sampler2D colours;
uniform bool isColoured;
uniform int light;  // 0: none, 1: of tissue, 2: of things
uniform vec3 paint, eye;
uniform float opacity;
uniform mat3 view;  // to the right, up and towards the viewer
uniform vec4 cut;
out vec4 pixel;
${lightShader}
void main() {
  if (dot(cut.xyz, at) > cut.w) discard;
  vec3 colour = paint;
  if (isColoured) colour = value < -0.01 ? vec3(${ink.noValue})
                                         : texture(colours, vec2((0.5 + 64.0 * clamp(value, 0.0, 1.0)) / 65.0, 0.5)).rgb;
  vec3 sight = view * normalize(eye - at), normal = view * normalize(across);
  if (dot(normal, sight) < 0.0) normal = -normal;
  if (light == 1) colour = lit_tissue(colour, normal, sight, 1.0);
  if (light == 2) colour = lit_thing(colour, normal);
  pixel = vec4(colour, opacity);
}`;
const lineVertexShader = `#version 300 es
layout(location = 0) in vec3 place;
uniform mat4 camera;
uniform vec3 eye;
uniform float size, nearer;
out vec3 at;
void main() {
  at = place;
  gl_Position = camera * vec4(place + nearer * normalize(eye - place), 1);
  gl_PointSize = size;
}`;
const ringSize = 2 * ink.ring.radius + ink.ring.width + ink.ring.rim;  // with its rim
const ringShare = beyond => (ink.ring.radius + beyond / 2) / ringSize;
const lineFragmentShader = `#version 300 es
precision highp float;
in vec3 at;
uniform vec4 paint, cut;
uniform int mark;  // 0: lines, 1: dots, 2: rings
out vec4 pixel;
void main() {
  if (dot(cut.xyz, at) > cut.w) discard;
  float radius = length(gl_PointCoord - 0.5);
  if (mark == 1 && radius > 0.5) discard;
  if (mark == 2 && (radius > 0.5 || radius < ${ringShare(-ink.ring.width - ink.ring.rim)})) discard;
  pixel = mark == 2 && (radius > ${ringShare(ink.ring.width)} || radius < ${ringShare(-ink.ring.width)}) ? vec4(1) : paint;
}`;

// A shaft with a cone at its end, as vertices of seven numbers.
function arrowVertices(from, to, girth) {
  const {sides, headLength, headWidth, maxHead} = ink.arrow, length = norm(subtract(to, from));
  if (!(length > 0)) return [];
  const along = scaled(subtract(to, from), 1 / length);
  const first = unit(cross(along, Math.abs(along[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0])), second = cross(along, first);
  const thick = Math.min(girth, maxHead * length / headLength), neck = add(to, along, -headLength * thick);
  const vertices = [];
  const put = (place, normal) => vertices.push(...place, ...normal, 0);
  for (let side = 0; side < sides; ++side) {
    const [a, b] = [side, side + 1].map(k => {
      const angle = 2 * Math.PI * k / sides;
      return add(scaled(first, Math.cos(angle)), second, Math.sin(angle));
    });
    const rim = (centre, out, radius) => add(centre, out, radius * thick);
    put(rim(from, a, 0.5), a); put(rim(from, b, 0.5), b); put(rim(neck, b, 0.5), b);
    put(rim(from, a, 0.5), a); put(rim(neck, b, 0.5), b); put(rim(neck, a, 0.5), a);
    const cone = out => unit(add(out, along, headWidth / headLength)), back = scaled(along, -1);
    put(rim(neck, a, headWidth), cone(a)); put(rim(neck, b, headWidth), cone(b)); put(to, cone(unit(add(a, b))));
    put(rim(neck, b, headWidth), back); put(rim(neck, a, headWidth), back); put(neck, back);
    put(rim(from, b, 0.5), back); put(rim(from, a, 0.5), back); put(from, back);
  }
  return vertices;
}

// From where the runs are seen.
class Camera {
  constructor(run) {
    this.home = {towards: unit(run.data.towards), up: unit(run.data.up)};
    const upright = unit(run.data.upright);
    this.upright = norm(cross(upright, this.home.towards)) > 0.05 ? upright : this.home.up;
    this.towards = this.home.towards;
    this.target = [0, 0, 0];
    this.distance = 1;
    this.shift = [0, 0];
  }

  get right() { return unit(cross(this.upright, this.towards)); }
  get up() { return cross(this.towards, this.right); }
  get eye() { return add(this.target, this.towards, this.distance); }

  // Around the upright axis, and up or down. [rad]
  turn(around, upwards) {
    const rotated = (vector, axis, angle) =>
      add(add(scaled(vector, Math.cos(angle)), cross(axis, vector), Math.sin(angle)), axis,
          dot(axis, vector) * (1 - Math.cos(angle)));
    const turned = rotated(this.towards, this.upright, around);
    const right = unit(cross(this.upright, turned));
    const lifted = unit(rotated(turned, right, upwards));
    this.towards = Math.abs(dot(lifted, this.upright)) < 0.999 ? lifted : turned;
  }

  zoom(factor) { this.distance = Math.min(Math.max(this.distance * factor, this.size / 50), 20 * this.size); }

  // By parts of the height of the picture.
  pan(x, y) {
    const height = 2 * this.distance * Math.tan(fieldOfView / 2);
    this.target = add(add(this.target, this.right, -x * height), this.up, y * height);
  }

  // So that all points are in a picture of this shape (width by height), above the part of its height that the colour
  // key has.
  fit(points, shape, keyShare) {
    this.towards = this.home.towards;
    const [right, up] = [this.right, this.up];
    const min = [1, 1, 1].map(() => Infinity), max = min.map(() => -Infinity);
    for (const point of points)
      [right, up, this.towards].forEach((axis, k) => {
        min[k] = Math.min(min[k], dot(axis, point));
        max[k] = Math.max(max[k], dot(axis, point));
      });
    const middle = min.map((number, k) => (number + max[k]) / 2);
    this.target = [right, up, this.towards].reduce((sum, axis, k) => add(sum, axis, middle[k]), [0, 0, 0]);
    this.size = Math.hypot(...min.map((number, k) => max[k] - number)) || 1;
    const whole = Math.tan(fieldOfView / 2), upwards = whole * (0.94 - keyShare), sideways = 0.94 * whole * shape;
    this.distance = this.size / 50;
    for (const point of points) {
      const from = subtract(point, this.target);
      const depth = dot(this.towards, from);
      this.distance = Math.max(this.distance, depth + Math.abs(dot(right, from)) / sideways,
                               depth + Math.abs(dot(up, from)) / upwards);
    }
    this.pan(0, -keyShare / 2);
  }

  // Where it looks at, in a picture of this height [pixels].
  pixelsPerMetre(height) { return height / (2 * this.distance * Math.tan(fieldOfView / 2)); }

  // Column by column.
  matrix(shape) {
    const [right, up, towards, eye] = [this.right, this.up, this.towards, this.eye];
    const far = this.distance + 3 * this.size, near = Math.max(this.distance - 3 * this.size, far / 2000);
    const y = 1 / Math.tan(fieldOfView / 2), x = y / shape;
    const a = (far + near) / (near - far), b = 2 * far * near / (near - far);
    const rows = [[...scaled(right, x), -x * dot(right, eye)], [...scaled(up, y), -y * dot(up, eye)],
                  [...scaled(towards, a), -a * dot(towards, eye) + b], [...scaled(towards, -1), dot(towards, eye)]];
    return Float32Array.from([0, 1, 2, 3].flatMap(column => rows.map(row => row[column])));
  }
}

// What is drawn with WebGL.
class Painter {
  constructor(canvas, colours) {
    const gl = canvas.getContext("webgl2", {antialias: true, alpha: false, stencil: true});
    if (!gl) throw new Error("there is no WebGL 2");
    this.gl = gl;
    this.surfaces = this.program(surfaceVertexShader, surfaceFragmentShader);
    this.lines = this.program(lineVertexShader, lineFragmentShader);
    this.vertexBuffer = gl.createBuffer();
    this.indexBuffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.vertexBuffer);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indexBuffer);
    const texels = new Uint8Array(4 * colours.length);
    colours.forEach((colour, k) => texels.set([...colour, 255], 4 * k));
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, colours.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, texels);
    for (const name of ["MIN_FILTER", "MAG_FILTER"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.LINEAR);
    for (const name of ["WRAP_S", "WRAP_T"]) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], gl.CLAMP_TO_EDGE);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.clearColor(...ink.paper, 1);
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const set = {};  // uniforms by their names
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++k) {
      const {name, type} = gl.getActiveUniform(program, k), place = gl.getUniformLocation(program, name);
      set[name] = {
        [gl.FLOAT]: value => gl.uniform1f(place, value),
        [gl.FLOAT_VEC3]: value => gl.uniform3fv(place, value),
        [gl.FLOAT_VEC4]: value => gl.uniform4fv(place, value),
        [gl.FLOAT_MAT3]: value => gl.uniformMatrix3fv(place, false, value),
        [gl.FLOAT_MAT4]: value => gl.uniformMatrix4fv(place, false, value)
      }[type] ?? (value => gl.uniform1i(place, value));
    }
    return {program, set};
  }

  // Everything that follows is seen so. cut: nothing is drawn where cut[0..2] . x > cut[3].
  begin(camera, [left, bottom, width, height]) {
    const gl = this.gl;
    gl.viewport(left, bottom, width, height);
    gl.scissor(left, bottom, width, height);
    this.matrix = camera.matrix(width / height);
    this.eye = camera.eye;
    const rows = [camera.right, camera.up, camera.towards];
    this.view = Float32Array.from([0, 1, 2].flatMap(column => rows.map(row => row[column])));
  }

  // sizes: how many numbers of a vertex belong to each attribute; indices: null: vertices as they follow
  draw({program, set}, sizes, kind, vertices, indices, uniforms) {
    const gl = this.gl, total = sizes.reduce((sum, size) => sum + size, 0);
    if (vertices.length === 0) return;
    gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STREAM_DRAW);
    gl.useProgram(program);
    let begin = 0;
    for (let k = 0; k < 3; ++k) {
      if (k >= sizes.length) { gl.disableVertexAttribArray(k); continue; }
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, sizes[k], gl.FLOAT, false, 4 * total, 4 * begin);
      begin += sizes[k];
    }
    const seen = {camera: this.matrix, eye: this.eye, view: this.view};
    for (const [name, value] of Object.entries({...seen, ...uniforms})) set[name]?.(value);
    if (!indices) return gl.drawArrays(gl[kind], 0, vertices.length / total);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STREAM_DRAW);
    gl.drawElements(gl[kind], indices.length, gl.UNSIGNED_INT, 0);
  }

  surface(vertices, indices, {paint = null, light = "tissue", cut = [0, 0, 0, 1], grow = 0, opacity = 1} = {}) {
    this.draw(this.surfaces, [3, 3, 1], "TRIANGLES", vertices, indices,
              {isColoured: !paint, light: ["none", "tissue", "thing"].indexOf(light), paint: paint ?? ink.ink, cut, grow, opacity});
  }

  // The foremost part of some surfaces, through which what has been drawn is seen.
  veil(drawSurfaces) {
    this.gl.colorMask(false, false, false, false);
    drawSurfaces({paint: ink.veil});
    this.gl.colorMask(true, true, true, true);
    drawSurfaces({paint: ink.veil, opacity: ink.veilOpacity});
  }

  // Set off by a rim [m] of paper from what is behind them.
  arrows(vertices, paint, {rim, cut = [0, 0, 0, 1]}) {
    const gl = this.gl, all = Float32Array.from(vertices);
    gl.depthMask(false);
    this.surface(all, null, {paint: ink.paper, light: "none", cut, grow: rim});
    gl.depthMask(true);
    this.surface(all, null, {paint, light: "thing", cut});
  }

  // Draws what lies in the plane of a cut, as far as that is within closed surfaces: there one sees more of their backs
  // than of their fronts.
  within(drawSurfaces, drawCap) {
    const gl = this.gl;
    gl.enable(gl.STENCIL_TEST);
    gl.clear(gl.STENCIL_BUFFER_BIT);
    gl.colorMask(false, false, false, false);
    gl.disable(gl.DEPTH_TEST);
    gl.stencilFunc(gl.ALWAYS, 0, 0xff);
    gl.stencilOpSeparate(gl.FRONT, gl.KEEP, gl.KEEP, gl.DECR_WRAP);
    gl.stencilOpSeparate(gl.BACK, gl.KEEP, gl.KEEP, gl.INCR_WRAP);
    drawSurfaces();
    gl.colorMask(true, true, true, true);
    gl.enable(gl.DEPTH_TEST);
    gl.stencilFunc(gl.NOTEQUAL, 0, 0xff);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
    drawCap();
    gl.disable(gl.STENCIL_TEST);
  }

  // kind: "LINES" or "POINTS"; indices: null: points as they follow; nearer: [m] before where they are
  marks(kind, points, indices, paint, {opacity = 1, nearer = 0, size = 1, mark = 0, cut = [0, 0, 0, 1]} = {}) {
    this.draw(this.lines, [3], kind, points, indices && Uint32Array.from(indices),
              {paint: [...paint, opacity], nearer, size, mark, cut});
  }
}

// "312 mN": three digits and a prefix of the SI.
function withUnit(value, unitName) {
  if (!(value > 0)) return `0 ${unitName}`;
  const thousands = Math.min(Math.max(Math.floor(Math.log10(+value.toPrecision(3)) / 3), -3), 3);
  return `${+(value / 1000 ** thousands).toPrecision(3)} ${["n", "µ", "m", "", "k", "M", "G"][thousands + 3]}${unitName}`;
}

// Both ends of a scale, and a few round numbers between them that leave room for those.
function ticksWithin(min, max) {
  const rough = (max - min) / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(factor => factor * power).find(candidate => candidate >= rough);
  const ticks = [], letters = value => `${+value.toPrecision(3)}`.length;
  const isApart = (tick, end) => Math.abs(tick - end) > 0.0115 * (letters(tick) + letters(end)) * (max - min);
  for (let k = Math.ceil(min / step - 1e-9); k * step <= max + 1e-9 * step; ++k)
    if (isApart(k * step, min) && isApart(k * step, max)) ticks.push(k * step);
  return [min, ...ticks, max];
}

class Viewer {
  constructor(figure, runs) {
    this.figure = figure;
    this.runs = runs;
    this.part = name => figure.querySelector(`[data-part="${name}"]`);
    this.canvas = this.part("canvas");
    const data = runs[0].data;
    const colours = data.colours.match(/../g).map(digits => parseInt(digits, 16));
    this.colours = Array.from({length: colours.length / 3}, (_, k) => colours.slice(3 * k, 3 * k + 3));
    this.painter = new Painter(this.canvas, this.colours);
    this.camera = new Camera(runs[0]);
    this.times = [...new Set(runs.flatMap(run => run.times))].sort((a, b) => a - b);
    this.time = this.times[this.times.length - 1];
    this.isBlended = false;
    this.isPlaying = false;
    this.cutNormal = null;
    this.makeFields();
    this.makeToggles();
    this.makeCut();
    this.listen();
    figure.hidden = false;
    this.part("slider").max = this.times.length - 1;
    this.say();
    this.fitted = false;
    new ResizeObserver(() => { this.resize(); }).observe(this.canvas);
    this.resize();
    this.goTo(this.time, false);
  }

  // Controls
  // -----------------------------------------------------------------------------------------------------------------

  makeFields() {
    this.fields = this.runs[0].data.fields.filter(field =>
      this.runs.every(run => run.data.fields.some(other => other.word === field.word)));
    const select = this.part("field");
    for (const field of this.fields) select.add(new Option(`${field.label} [${field.unit}]`, field.word));
    const namesOf = run => run.regions.map(region => region.name).join("/");
    const hasRegions = this.runs[0].regions.length > 0 && this.runs.every(run => namesOf(run) === namesOf(this.runs[0]));
    if (hasRegions) select.add(new Option("region", "region"));
    this.makeWithin(hasRegions);
    // the one of the pictures, unless it has nothing to show
    const hasRange = field => field.shown[1] > field.shown[0];
    const wanted = this.fields.find(field => field.word === this.runs[0].data.field && hasRange(field)) ??
                   this.fields.find(hasRange) ?? this.fields[0];
    if (wanted) select.value = wanted.word;
    if (hasRegions && this.runs[0].data.field === "region") select.value = "region";
    select.addEventListener("change", () => this.chooseField(select.value));
    this.chooseField(select.value);
  }

  // Which regions are shown within the body.
  makeWithin(hasRegions) {
    const select = this.part("within");
    this.within = hasRegions ? this.runs[0].data.shownRegions : [];
    select.parentElement.hidden = !hasRegions;
    this.runs[0].regions.forEach(({name}, number) => { if (number > 0) select.add(new Option(name, number)); });
    if (this.within.length > 1) select.add(new Option("some regions", this.within));
    select.value = this.within;
    select.addEventListener("change", () => {
      this.within = select.value.split(",").filter(Boolean).map(Number);
      this.redraw();
    });
  }

  chooseField(word) {
    this.field = word;
    const own = this.runs.map(run => run.data.fields.find(field => field.word === word));
    this.range = [Math.min(...own.map(field => field?.shown[0] ?? 0)), Math.max(...own.map(field => field?.shown[1] ?? 0))];
    const [min, max] = this.range, isFlat = !(max > min);
    const bar = this.part("bar"), ticks = this.part("ticks");
    bar.style.background =
      `linear-gradient(to right, ${this.colours.map(colour => `rgb(${colour.join(" ")})`).join(", ")})`;
    bar.hidden = isFlat;
    this.part("label").textContent = isFlat || !own[0] ? "" : `${own[0].label} [${own[0].unit}]`;
    ticks.replaceChildren();
    if (word === "region") {
      for (const {name, colour} of this.runs[0].regions) {
        const entry = document.createElement("b"), swatch = document.createElement("i");
        swatch.style.background = `#${colour}`;
        entry.append(swatch, ` ${name} `);
        this.part("label").append(entry);
      }
    } else if (isFlat) {
      const label = own[0]?.label ?? "nothing";
      ticks.textContent = max === 0 ? `no ${label} in this run` : `${label}: ${+max.toPrecision(4)} everywhere`;
    } else {
      for (const value of ticksWithin(min, max)) {
        const tick = document.createElement("span");
        tick.textContent = `${+value.toPrecision(3)}`;
        tick.style.left = `${100 * (value - min) / (max - min)}%`;
        ticks.append(tick);
      }
    }
    this.redraw();
  }

  makeToggles() {
    const data = this.runs.map(run => run.data);
    const some = of => this.runs.some(run => run.data.states.some(of));
    const isEmbedded = data.some(one => one.embedded.length > 0);
    const load = this.strongestLoad = Math.max(...this.runs.map(run => run.strongestLoad));
    const tool = this.strongestTool = Math.max(...this.runs.map(run => run.strongestTool));
    const wanted = [
      ["surface", isEmbedded, "surface", true],
      ["edges", true, isEmbedded ? "hexahedra around it" : "mesh edges", data[0].showsHexahedra],
      ["ghost", true, "initial shape", true],
      ["fixed", this.runs.some(run => run.fixedNodes.some(nodes => nodes.length > 0)), "fixed nodes",
       !isEmbedded || data[0].showsHexahedra],  // those of a cage that is hidden would hang in the air
      ["springs", some(state => state.springs), "springs, paler where slack", true],
      ["loads", load > 0, `loads, up to ${withUnit(load, "N")} per node`, true],
      ["tools", some(state => state.tools), tool > 0 ? `instruments, force up to ${withUnit(tool, "N")}` : "instruments",
       true]];
    this.shows = {};
    const bodies = data[0].bodies.length > 1 ? data[0].bodies : [];
    this.part("bodies").textContent = bodies.length > 0 ? `Bodies: ${bodies.map(body => body.name).join(", ")}. ` : "";
    for (const [name, isThere, label, isOn] of wanted) {
      this.shows[name] = isThere && isOn;
      if (!isThere) continue;
      const element = document.createElement("label"), box = document.createElement("input");
      element.className = `toggle ${name}`;
      box.type = "checkbox";
      box.checked = isOn;
      box.dataset.shows = name;
      box.addEventListener("change", () => { this.shows[name] = box.checked; this.redraw(); });
      const swatch = document.createElement("i");
      swatch.setAttribute("aria-hidden", "true");
      const colour = {ghost: ink.ghost, fixed: ink.ink, springs: ink.spring, loads: ink.load, tools: ink.steel}[name];
      if (colour) swatch.style.background = `rgb(${colour.map(part => 255 * part).join(" ")})`;
      element.append(box, swatch, ` ${label}`);
      this.part("toggles").append(element);
    }
  }

  makeCut() {
    const select = this.part("cut"), slider = this.part("offset");
    select.addEventListener("change", () => {
      const axis = "xyz".indexOf(select.value);
      slider.hidden = axis < 0;
      this.cutNormal = null;
      if (axis >= 0) {
        // the half nearer to the reader goes
        const normal = [0, 0, 0];
        normal[axis] = this.camera.towards[axis] >= 0 ? 1 : -1;
        this.cutNormal = normal;
      }
      this.redraw();
    });
    slider.addEventListener("input", () => this.redraw());
  }

  // As the shader takes it. A plane of symmetry would run along the faces of a mesh: it is passed by a little.
  get cut() {
    if (!this.cutNormal) return [0, 0, 0, 1];
    const axis = this.cutNormal.findIndex(number => number !== 0), fraction = this.part("offset").value / 1000 + 7e-4;
    const box = this.runs[0].data.box;
    return [...this.cutNormal, this.cutNormal[axis] * (box[axis] + fraction * (box[3 + axis] - box[axis]))];
  }

  listen() {
    const canvas = this.canvas, pointers = new Map();
    canvas.addEventListener("pointerdown", event => {
      canvas.focus({preventScroll: true});
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener("pointermove", event => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const height = canvas.clientHeight;
      const [x, y] = [(event.clientX - before[0]) / height, (event.clientY - before[1]) / height];
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
        const apart = place => Math.hypot(place[0] - other[0], place[1] - other[1]) || 1;
        this.camera.zoom(apart(before) / apart([event.clientX, event.clientY]));
        this.camera.pan(x / 2, y / 2);
      } else if (event.shiftKey || event.buttons & 2 || event.buttons & 4) {
        this.camera.pan(x, y);
      } else {
        this.camera.turn(-4 * x, -4 * y);
      }
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      this.redraw();
    });
    const release = event => pointers.delete(event.pointerId);
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("dblclick", () => this.goHome());
    // the wheel scrolls the page, unless the reader has chosen the picture
    canvas.addEventListener("wheel", event => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      this.camera.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 200) / 600));
      this.redraw();
    }, {passive: false});
    canvas.addEventListener("keydown", event => this.press(event));

    const slider = this.part("slider");
    slider.addEventListener("input", () => { this.stop(); this.goTo(this.times[slider.value]); });
    this.part("play").addEventListener("click", () => this.isPlaying ? this.stop() : this.play());
    this.part("home").addEventListener("click", () => this.goHome());
    document.addEventListener("hexaplast:time", event => {
      if (event.detail.from === this || event.detail.time === null) return;
      this.stop();
      this.goTo(event.detail.time, false);
    });
    canvas.addEventListener("webglcontextlost", () => { this.figure.hidden = true; });
  }

  press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const turns = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    const nearest = nearestIn(this.times, this.time);
    if (turns && event.shiftKey) this.camera.pan(0.05 * turns[0], 0.05 * turns[1]);
    else if (turns) this.camera.turn(-0.12 * turns[0], -0.12 * turns[1]);
    else if (event.key === "+" || event.key === "=") this.camera.zoom(0.88);
    else if (event.key === "-") this.camera.zoom(1 / 0.88);
    else if (event.key === "0" || event.key === "Home") this.goHome();
    else if (event.key === " ") this.isPlaying ? this.stop() : this.play();
    else if (event.key === ",") { this.stop(); this.goTo(this.times[Math.max(nearest - 1, 0)]); }
    else if (event.key === ".") { this.stop(); this.goTo(this.times[Math.min(nearest + 1, this.times.length - 1)]); }
    else return;
    event.preventDefault();
    this.redraw();
  }

  // What a page says of the states that it has.
  say() {
    const words = this.runs.map((run, k) => {
      const name = this.runs.length > 1 ? `${"AB"[k]}: ` : "";
      const {states, nodes, hexahedra} = run.data, steps = states[states.length - 1].step - states[0].step;
      const thinned = steps + 1 > states.length ? `${states.length} states of ${steps} steps` : `all ${steps} steps`;
      const cause = run.data.thinned ? `, fewer than usual since there are ${nodes} nodes` : "";
      return `${name}${hexahedra} hexahedra, ${thinned}${cause}.`;
    });
    this.part("say").textContent = words.join(" ");
    this.part("names").hidden = this.runs.length < 2;
  }

  // Time
  // -----------------------------------------------------------------------------------------------------------------

  // isTold: whether the charts follow
  goTo(time, isTold = true) {
    this.time = Math.min(Math.max(time, this.times[0]), this.times[this.times.length - 1]);
    this.isBlended = this.isPlaying;
    const index = nearestIn(this.times, this.time), slider = this.part("slider");
    if (!this.isBlended) this.time = this.times[index];
    slider.value = index;
    const step = this.runs[0].data.states[nearestIn(this.runs[0].times, this.time)].step;
    const words = `t = ${this.time.toFixed(this.decimals)} s`;
    this.part("time").textContent = words;
    slider.setAttribute("aria-valuetext", `${words}, step ${step}`);
    this.figure.dataset.step = step;
    if (isTold) tellTime(this.time, this);
    this.redraw();
  }

  get decimals() { return Math.min(Math.max(Math.ceil(-Math.log10(this.runs[0].data.dt) - 1e-9), 2), 6); }

  play() {
    const first = this.times[0], length = this.times[this.times.length - 1] - first;
    if (!(length > 0)) return;
    const speed = length / Math.min(Math.max(length, 4), 9);  // [s] of the run per second
    if (this.time >= first + 0.999 * length) this.time = first;
    this.isPlaying = true;
    this.goTo(this.time);
    this.showButton();
    let before = performance.now();
    const advance = now => {
      if (!this.isPlaying) return;
      const time = this.time + speed * Math.min(now - before, 100) / 1000;
      before = now;
      if (time >= first + length) this.isPlaying = false;
      this.goTo(time);
      if (this.isPlaying) requestAnimationFrame(advance);
      else this.showButton();
    };
    requestAnimationFrame(advance);
  }

  stop() {
    if (!this.isPlaying) return;
    this.isPlaying = false;
    this.showButton();
    this.goTo(this.time);
  }

  showButton() {
    const button = this.part("play");
    button.textContent = this.isPlaying ? "❚❚" : "▶";
    button.setAttribute("aria-label", this.isPlaying ? "Pause" : "Play");
    this.figure.dataset.plays = this.isPlaying;
  }

  // Drawing
  // -----------------------------------------------------------------------------------------------------------------

  goHome() {
    this.fit();
    this.redraw();
  }

  // What has to be in the picture: bodies in all states, and instruments that are near them.
  fit() {
    const points = [];
    for (const run of this.runs) {
      const box = run.data.box, min = box.slice(0, 3), max = box.slice(3);
      const margin = 0.2 * norm(subtract(max, min));
      const isNear = point => point.every((number, axis) => number > min[axis] - margin && number < max[axis] + margin);
      const stride = Math.max(1, Math.floor(run.numNodes / 2000));
      const take = places => { for (let k = 0; k < places.length / 3; k += stride) points.push(pointAt(places, k)); };
      const surfaces = positions => run.data.showsHexahedra || run.data.embedded.length === 0
        ? [positions] : run.data.embedded.map((range, number) => run.embeddedPoints(number, positions));
      surfaces(run.original).forEach(take);
      const some = Math.max(1, Math.floor(run.times.length / 8));
      for (let s = run.times.length - 1; s >= 0; s -= some) {
        surfaces(run.positions(s)).forEach(take);
        const tools = run.data.states[s].tools ?? [], ends = run.springEnds({low: s, high: s, fraction: 0}) ?? [];
        for (const places of [...tools.map(tool => run.toolPoints(tool)), ends])
          for (let k = 0; k < places.length / 3; ++k) if (isNear(pointAt(places, k))) points.push(pointAt(places, k));
      }
    }
    const [, , width, height] = this.frames()[0];
    this.camera.fit(points, width / height, Math.min(keyHeight * this.pixel / height, 0.3));
  }

  resize() {
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(scale * this.canvas.clientWidth), height = Math.round(scale * this.canvas.clientHeight);
    if (width === 0 || height === 0) return;
    this.canvas.width = width;
    this.canvas.height = height;
    this.pixel = scale;
    if (!this.fitted) this.fit();
    this.fitted = true;
    this.redraw();
  }

  // The part of the canvas that each run is drawn in.
  frames() {
    const {width, height} = this.canvas, count = this.runs.length;
    return this.runs.map((run, k) => [Math.round(k * width / count), 0, Math.round(width / count), height]);
  }

  redraw() {
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.draw();
    });
  }

  draw() {
    const gl = this.painter.gl;
    if (!this.fitted || gl.isContextLost()) return;
    gl.enable(gl.SCISSOR_TEST);
    this.frames().forEach((frame, k) => {
      this.painter.begin(this.camera, frame);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      this.drawRun(this.runs[k], frame[3]);
    });
    this.drawAxes();
    this.figure.dataset.drawn = (+this.figure.dataset.drawn || 0) + 1;
  }

  // How x, y and z run, or left, back and head of a patient: the farthest first.
  drawAxes() {
    const {right, up, towards} = this.camera, names = this.runs[0].data.anatomical ? "LPS" : "xyz";
    this.part("axes").innerHTML = [0, 1, 2].sort((a, b) => towards[a] - towards[b]).map(axis => {
      const at = length => `${(length * right[axis]).toFixed(1)} ${(-length * up[axis]).toFixed(1)}`;
      const colour = `rgb(${ink.axes[axis].map(part => Math.round(255 * part)).join(" ")})`;
      return `<path d="M0 0L${at(24)}" stroke="${colour}"/>` +
        `<text transform="translate(${at(35)})" fill="${colour}">${names[axis]}</text>`;
    }).join("");
  }

  drawRun(run, height) {
    const nearest = nearestIn(run.times, this.time);
    let moment = {low: nearest, high: nearest, fraction: 0};
    if (this.isBlended) {
      const between = run.between(this.time);
      if (run.sameSurfaceAs[between.low] === run.sameSurfaceAs[between.high]) moment = between;
    }
    const positions = run.blendedPositions(moment), topology = run.topology(moment.low);
    const field = run.data.fields.find(other => other.word === this.field);
    const fractions = field ? run.blendedFractions(field, moment, this.range) : new Float32Array(run.numNodes);
    if (this.shows.ghost && this.within.length === 0) this.drawGhost(run);
    this.drawBodies(run, topology, positions, fractions, moment.low, height);
    if (this.shows.springs) this.drawSprings(run, moment);
    this.drawMarks(run, topology, positions, nearest, height);
    if (this.within.length > 0) this.drawVeil(run, topology, positions);
  }

  drawVeil(run, topology, positions) {
    const isEmbedded = topology.embedded.length > 0 && this.shows.surface;
    const surfaces = isEmbedded
      ? topology.embedded.map((surface, number) => [surface, run.embeddedPoints(number, positions)])
      : [[topology.body, positions]];
    this.painter.veil(how => {
      for (const [surface, points] of surfaces)
        this.painter.surface(surface.vertices(points, () => 0), surface.triangles, {...how, cut: this.cut});
    });
  }

  // A pale shadow behind everything else, however near it is.
  drawGhost(run) {
    const gl = this.painter.gl, topology = run.topology(0);
    const ghosts = topology.embedded.length > 0
      ? topology.embedded.map((surface, number) => [surface, run.embeddedPoints(number, run.original)])
      : [[topology.body, run.original]];
    gl.disable(gl.DEPTH_TEST);
    for (const [surface, points] of ghosts)
      this.painter.surface(surface.vertices(points, () => 0), surface.triangles, {paint: ink.ghost, light: "none"});
    for (const [surface, points] of ghosts)
      this.painter.marks("LINES", points, surface.outline(points, this.camera.eye), ink.outline);
    gl.enable(gl.DEPTH_TEST);
  }

  drawBodies(run, topology, positions, fractions, state, height) {
    const gl = this.painter.gl, cut = this.cut, isEmbedded = topology.embedded.length > 0 && this.within.length === 0;
    // edges grow fainter with their length on the screen; lines of WebGL are never thinner than a pixel
    const {shortest, longest, widest, strongest, cageOpacity} = ink.edges;
    const length = topology.body.meanEdge * this.camera.pixelsPerMetre(height) / this.pixel;
    const fraction = Math.min(1, length / longest), thinness = Math.min(1, widest * Math.sqrt(fraction) * this.pixel);
    const edgeOpacity = length < shortest ? 0 : isEmbedded ? cageOpacity : strongest * fraction * thinness;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    const isWithin = this.within.length > 0, showsRegions = this.field === "region";
    const parts = isWithin ? run.parts(state).filter((part, number) => this.within.includes(number))
                : showsRegions ? run.parts(state) : [topology];
    const paintOf = part => showsRegions ? part.paint : null;
    const drawSection = () => parts.flatMap(part => {
      const section = run.cut(part.alive, positions, fractions, this.cutNormal, cut[3]);
      this.painter.surface(section.vertices, null, {paint: paintOf(part), light: "none"});  // who cuts wants to read values there
      return [...section.lines];
    });
    if (isEmbedded && this.shows.surface) {
      const surfaces = parts.flatMap(part => part.embedded.map((surface, number) => {
        const values = run.blend(number, fractions, 1);
        return [surface.vertices(run.embeddedPoints(number, positions), point => values[point]), surface.triangles,
                {paint: paintOf(part), cut}];
      }));
      const drawAll = () => surfaces.forEach(one => this.painter.surface(...one));
      drawAll();
      if (this.cutNormal && topology.embedded.every(surface => surface.isClosed))
        this.painter.within(drawAll, drawSection);
    }
    if (!isEmbedded) {
      for (const part of parts)
        this.painter.surface(part.body.vertices(positions, node => fractions[node]), part.body.triangles,
                             {paint: paintOf(part), cut});
      if (this.cutNormal) {
        const lines = Float32Array.from(drawSection());
        const nearer = 5e-4 * this.camera.size;
        if (this.shows.edges) this.painter.marks("LINES", lines, null, ink.edge, {opacity: edgeOpacity, nearer});
      }
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (!this.shows.edges) return;
    const edges = isWithin ? parts.flatMap(part => part.body.edges) : topology.body.edges;
    this.painter.marks("LINES", positions, edges, isEmbedded ? ink.cage : ink.edge,
                       {opacity: edgeOpacity, cut});
  }

  drawSprings(run, moment) {
    const ends = run.springEnds(moment);
    if (!ends) return;
    const slack = new Set(run.data.states[moment.low].springs.slack ?? []), taut = [], loose = [];
    for (let k = 0; k < ends.length / 6; ++k) (slack.has(k) ? loose : taut).push(2 * k, 2 * k + 1);
    this.painter.marks("LINES", ends, taut, ink.spring, {cut: this.cut});
    this.painter.marks("LINES", ends, loose, ink.spring, {opacity: ink.slackOpacity, cut: this.cut});
  }

  drawMarks(run, topology, positions, state, height) {
    const gl = this.painter.gl, cut = this.cut, {tools = [], loads = []} = run.data.states[state];
    const box = run.data.box, diagonal = norm(subtract(box.slice(3), box.slice(0, 3)));
    const longest = ink.arrow.longest * diagonal, girth = ink.arrow.girth * longest;
    const rim = ink.arrow.rim * this.pixel / this.camera.pixelsPerMetre(height);
    if (this.shows.fixed) {
      const length = topology.body.meanEdge * this.camera.pixelsPerMetre(height) / this.pixel;
      const radius = Math.min(ink.dot.radius, ink.dot.ofEdge * length);
      const nodes = run.fixedNodes[state].filter(node => topology.onSurface(node));
      this.painter.marks("POINTS", positions, nodes, ink.ink, {size: 2 * radius * this.pixel, mark: 1, nearer: 0.004 * diagonal, cut});
    }
    if (this.shows.loads && loads.length > 0) {
      const outwards = topology.normals(positions);
      const vertices = loads.flatMap(([node, ...force]) => {
        const place = pointAt(positions, node), along = scaled(force, longest / this.strongestLoad);
        const presses = dot(outwards(node), unit(force)) < -ink.arrow.presses;  // then it points at its node from outside
        return presses ? arrowVertices(subtract(place, along), place, girth)
                       : arrowVertices(place, add(place, along), girth);
      });
      this.painter.arrows(vertices, ink.load, {rim, cut});
    }
    if (!this.shows.tools || tools.length === 0) return;
    const rings = [], arrows = [];
    for (const tool of tools) {
      const points = run.toolPoints(tool), surface = run.toolSurface(tool, points);
      if (surface) {
        gl.enable(gl.POLYGON_OFFSET_FILL);
        this.painter.surface(surface.vertices(points, () => 0), surface.triangles, {paint: ink.metal, light: "thing"});
        gl.disable(gl.POLYGON_OFFSET_FILL);
        this.painter.marks("LINES", points, surface.outline(points, this.camera.eye), ink.steel);
      } else {
        rings.push(...tool.place);
      }
      if (this.strongestTool > 0)
        arrows.push(...arrowVertices(tool.place, add(tool.place, tool.force, longest / this.strongestTool), girth));
    }
    // seen also where they lie within the tissue
    gl.depthRange(0, 0.01);
    this.painter.arrows(arrows, ink.steel, {rim});
    gl.disable(gl.DEPTH_TEST);
    this.painter.marks("POINTS", Float32Array.from(rings), null, ink.steel, {size: ringSize * this.pixel, mark: 2});
    gl.enable(gl.DEPTH_TEST);
    gl.depthRange(0, 1);
  }
}

async function openViewer(figure) {
  try {
    const all = [...figure.querySelectorAll("script.run")].map(script => JSON.parse(script.textContent));
    const viewer = new Viewer(figure, await Promise.all(all.map(async data => new Run(data, await unpack(data)))));
    // once, when it is first seen
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) whenSeen(figure, () => viewer.play());
  } catch (reason) {
    figure.hidden = true;
    figure.dataset.failed = reason.message;
  }
}

function whenSeen(figure, act) {
  new IntersectionObserver((entries, observer) => {
    if (!entries.some(entry => entry.isIntersecting)) return;
    observer.disconnect();
    act();
  }, {threshold: 0.3}).observe(figure);
}

const viewerFigure = document.querySelector("figure.viewer");
if (viewerFigure) openViewer(viewerFigure);
