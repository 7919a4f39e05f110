// SPDX-License-Identifier: LGPL-2.1-or-later
// What a run's data hold, as the viewer draws it: surfaces, their edges and normals, values, and cuts.
"use strict";

// Corners of a hexahedron: its faces, counter-clockwise seen from outside, and six tetrahedra that fill it.
const hexFaces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
const hexTetrahedra = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
const noValue = 255;

const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const add = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = a => Math.hypot(a[0], a[1], a[2]);
const scaled = (a, factor) => [factor * a[0], factor * a[1], factor * a[2]];
const unit = a => scaled(a, 1 / (norm(a) || 1));
const pointAt = (points, k) => [points[3 * k], points[3 * k + 1], points[3 * k + 2]];

const blended = (numbers, others, fraction) => numbers.map((number, k) => number + fraction * (others[k] - number));

// Arrays of whole numbers, as PackedNumbers (plugin/record) writes them.
async function unpack(data) {
  const deflated = Uint8Array.from(atob(data.data), letter => letter.charCodeAt(0));
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const arrays = {};
  let begin = 0;
  for (const {name, bits, count, stride} of data.arrays) {
    const values = new {8: Uint8Array, 16: Uint16Array, 32: Uint32Array}[bits](count);
    for (let i = 0; i < count; ++i) {
      let folded = 0;
      for (let byte = 0; byte < bits / 8; ++byte) folded += bytes[begin + byte * count + i] * 2 ** (8 * byte);
      const difference = folded % 2 ? -(folded + 1) / 2 : folded / 2;
      values[i] = (i < stride ? 0 : values[i - stride]) + difference;
    }
    arrays[name] = values;
    begin += count * bits / 8;
  }
  if (begin !== bytes.length) throw new Error("the states are damaged");
  return arrays;
}

// Faces of four points (triangles name the last one twice) that move with their points.
class Surface {
  constructor(points, faces) {
    this.faces = faces;
    const numFaces = faces.length / 4;
    const normals = this.faceNormals(points);
    for (let f = 0; f < numFaces; ++f) normals.set(unit(pointAt(normals, f)), 3 * f);

    // corners around a point share a vertex, and so a normal, unless a crease parts them
    const around = new Map();
    for (let f = 0; f < numFaces; ++f)
      for (let k = 0; k < this.size(f); ++k) {
        const point = faces[4 * f + k];
        if (!around.has(point)) around.set(point, []);
        around.get(point).push(4 * f + k);
      }
    const pointOf = [];
    this.vertexOfCorner = new Uint32Array(faces.length);
    for (const [point, corners] of around) {
      const groups = [];
      for (const corner of corners) {
        const normal = pointAt(normals, corner >> 2);
        const near = groups.filter(group =>
          group.some(other => dot(normal, pointAt(normals, other >> 2)) > ink.crease));
        const merged = [corner, ...near.flat()];
        for (const group of near) groups.splice(groups.indexOf(group), 1);
        groups.push(merged);
      }
      for (const group of groups) {
        for (const corner of group) this.vertexOfCorner[corner] = pointOf.length;
        pointOf.push(point);
      }
    }
    this.pointOfVertex = Uint32Array.from(pointOf);

    const triangles = [];
    for (let f = 0; f < numFaces; ++f) {
      const [a, b, c, d] = this.vertexOfCorner.subarray(4 * f, 4 * f + 4);
      triangles.push(a, b, c);
      if (this.size(f) === 4) triangles.push(a, c, d);
    }
    this.triangles = Uint32Array.from(triangles);

    const facesOfEdge = new Map();
    const numPoints = points.length / 3;
    for (let f = 0; f < numFaces; ++f)
      for (let k = 0; k < this.size(f); ++k) {
        const a = faces[4 * f + k], b = faces[4 * f + (k + 1) % this.size(f)];
        const key = Math.min(a, b) * numPoints + Math.max(a, b);
        if (!facesOfEdge.has(key)) facesOfEdge.set(key, []);
        facesOfEdge.get(key).push(f);
      }
    this.meanEdge = 0;
    this.isClosed = true;  // two faces meet at each edge
    this.edges = [];  // of points
    this.creases = [];
    this.smooth = [];  // edges with the two faces beside them
    for (const [key, beside] of facesOfEdge) {
      const edge = [Math.floor(key / numPoints), key % numPoints];
      this.edges.push(...edge);
      this.isClosed &&= beside.length === 2;
      this.meanEdge += norm(subtract(pointAt(points, edge[1]), pointAt(points, edge[0]))) / facesOfEdge.size;
      if (beside.length === 2 && dot(pointAt(normals, beside[0]), pointAt(normals, beside[1])) >= ink.crease)
        this.smooth.push([...edge, ...beside]);
      else
        this.creases.push(...edge);
    }
  }

  size(face) { return this.faces[4 * face + 2] === this.faces[4 * face + 3] ? 3 : 4; }

  // Twice as long as the areas.
  faceNormals(points) {
    const normals = new Float32Array(this.faces.length / 4 * 3);
    for (let f = 0; f < this.faces.length / 4; ++f) {
      const [a, b, c, d] = [0, 1, 2, 3].map(k => pointAt(points, this.faces[4 * f + k]));
      normals.set(cross(subtract(c, a), subtract(d, b)), 3 * f);
    }
    return normals;
  }

  // Seven numbers per vertex: place, normal, value.
  vertices(points, valueAt) {
    const normals = this.faceNormals(points);
    const buffer = new Float32Array(7 * this.pointOfVertex.length);
    for (let f = 0; f < this.faces.length / 4; ++f)
      for (let k = 0; k < this.size(f); ++k)
        for (let axis = 0; axis < 3; ++axis)
          buffer[7 * this.vertexOfCorner[4 * f + k] + 3 + axis] += normals[3 * f + axis];
    for (let v = 0; v < this.pointOfVertex.length; ++v) {
      const point = this.pointOfVertex[v];
      for (let axis = 0; axis < 3; ++axis) buffer[7 * v + axis] = points[3 * point + axis];
      buffer[7 * v + 6] = valueAt(point);
    }
    return buffer;
  }

  // Creases, and edges between a face that is turned to the eye and one that is not.
  outline(points, eye) {
    const normals = this.faceNormals(points);
    const isTowards = face => {
      const place = pointAt(points, this.faces[4 * face]);
      return dot(pointAt(normals, face), subtract(eye, place)) > 0;
    };
    const lines = [...this.creases];
    for (const [a, b, one, other] of this.smooth) if (isTowards(one) !== isTowards(other)) lines.push(a, b);
    return lines;
  }
}

// A run: its states and what can be asked of them.
class Run {
  constructor(data, arrays) {
    this.data = data;
    this.arrays = arrays;
    this.numNodes = data.nodes;
    this.regions = data.regions ?? [];  // of earlier versions: none
    this.times = data.states.map(state => state.time);
    this.original = this.placesIn(arrays.original, data.box, 0, this.numNodes);
    this.topologies = new Map();  // by the state that they begin with

    // the state from which on a surface is the one of each state, and what holds it
    this.sameSurfaceAs = [];
    this.fixedNodes = [];
    data.states.forEach((state, s) => {
      this.sameSurfaceAs.push(s > 0 && !state.gone ? this.sameSurfaceAs[s - 1] : s);
      this.fixedNodes.push(state.fixed ?? this.fixedNodes[s - 1] ?? []);
    });
    this.strongestLoad = Math.max(0, ...data.states.flatMap(state => (state.loads ?? []).map(load =>
      norm(load.slice(1)))));
    this.strongestTool = Math.max(0, ...data.states.flatMap(state => (state.tools ?? []).map(tool =>
      norm(tool.force))));
    this.shapes = [];
    for (let s = 0; s < data.shapes; ++s) {
      const triangles = arrays[`shape_${s}`], faces = [];
      for (let k = 0; k < triangles.length; k += 3)
        faces.push(triangles[k], triangles[k + 1], triangles[k + 2], triangles[k + 2]);
      this.shapes.push({faces: Uint32Array.from(faces), surface: null});
    }
  }

  placesIn(numbers, box, first, count) {
    const places = new Float32Array(3 * count);
    for (let i = 0; i < 3 * count; ++i) {
      const axis = i % 3;
      places[i] = box[axis] + numbers[3 * first + i] / 65535 * (box[3 + axis] - box[axis]);
    }
    return places;
  }

  // Two states and how far the time has come from the one to the other; between states that differ by more than
  // positions there is nothing to blend.
  between(time) {
    let low = 0;
    while (low + 2 < this.times.length && this.times[low + 1] <= time) ++low;
    const high = Math.min(low + 1, this.times.length - 1);
    const length = this.times[high] - this.times[low];
    return {low, high, fraction: length > 0 ? Math.min(Math.max((time - this.times[low]) / length, 0), 1) : 0};
  }

  positions(state) { return this.placesIn(this.arrays.positions, this.data.box, state * this.numNodes, this.numNodes); }

  blendedPositions({low, high, fraction}) {
    const places = this.positions(low);
    return fraction === 0 ? places : blended(places, this.positions(high), fraction);
  }

  // Of a node: the fraction of the scale, or -1 where there is no value.
  fractions(field, state, [least, most]) {
    const numbers = this.arrays[`values_${field.word}`].subarray(state * this.numNodes, (state + 1) * this.numNodes);
    const table = new Float32Array(256);
    for (let k = 0; k < 255; ++k) {
      const value = field.least + k / 254 * (field.most - field.least);
      table[k] = most > least ? Math.min(Math.max((value - least) / (most - least), 0), 1) : 0;
    }
    table[noValue] = -1;
    const fractions = new Float32Array(this.numNodes);
    for (let node = 0; node < this.numNodes; ++node) fractions[node] = table[numbers[node]];
    return fractions;
  }

  blendedFractions(field, {low, high, fraction}, range) {
    const fractions = this.fractions(field, low, range);
    if (fraction === 0) return fractions;
    const others = this.fractions(field, high, range);
    return fractions.map((number, node) =>
      number >= 0 && others[node] >= 0 ? number + fraction * (others[node] - number) : number);
  }

  // What is there at a state: hexahedra, the surface of the bodies, and the embedded surfaces.
  topology(state) {
    const begin = this.sameSurfaceAs[state];
    if (this.topologies.has(begin)) return this.topologies.get(begin);
    const gone = new Set(this.data.states.slice(0, begin + 1).flatMap(other => other.gone ?? []));
    const hexahedra = this.arrays.hexahedra;
    const alive = [];
    for (let e = 0; e < hexahedra.length / 8; ++e) if (!gone.has(e)) alive.push(e);

    const body = this.boundary(alive);
    const embedded = this.data.embedded.map((range, number) => {
      const faces = this.arrays[`faces_${number}`], carriers = this.arrays[`carriers_${number}`];
      const left = [];
      for (let f = 0; f < faces.length; f += 4) {
        const face = faces.subarray(f, f + 4);
        if (face.every(point => !gone.has(carriers[point]))) left.push(...face);
      }
      return new Surface(this.embeddedPoints(number, this.original), Uint32Array.from(left));
    });
    const topology = {alive, body, embedded};
    const points = new Set(body.pointOfVertex);
    topology.onSurface = node => points.has(node);
    topology.normals = positions => {  // of the body at its nodes, of any length
      const sums = new Float32Array(3 * this.numNodes), normals = body.faceNormals(positions);
      body.faces.forEach((node, corner) => {
        for (let axis = 0; axis < 3; ++axis) sums[3 * node + axis] += normals[3 * (corner >> 2) + axis];
      });
      return node => unit(pointAt(sums, node));
    };
    this.topologies.set(begin, topology);
    return topology;
  }

  // The surface of some hexahedra.
  boundary(some) {
    const hexahedra = this.arrays.hexahedra, inner = new Map();
    const keyOf = nodes => {
      const [a, b, c] = [...nodes].sort((p, q) => p - q);
      return (a * this.numNodes + b) * this.numNodes + c;
    };
    for (const e of some)
      for (const face of hexFaces) {
        const nodes = face.map(corner => hexahedra[8 * e + corner]);
        const key = keyOf(nodes);
        if (inner.has(key)) inner.delete(key);
        else inner.set(key, nodes);
      }
    return new Surface(this.original, Uint32Array.from([...inner.values()].flat()));
  }

  // The same of each region by itself, with its colour.
  parts(state) {
    const topology = this.topology(state), regionOf = this.arrays.regions;
    topology.parts ??= this.regions.map(({colour}, number) => {
      const alive = topology.alive.filter(e => regionOf[e] === number);
      const embedded = topology.embedded.map(({faces}, k) => {
        const carriers = this.arrays[`carriers_${k}`], own = [];
        for (let f = 0; f < faces.length; f += 4)
          if (regionOf[carriers[faces[f]]] === number) own.push(...faces.subarray(f, f + 4));
        return new Surface(this.embeddedPoints(k, this.original), Uint32Array.from(own));
      });
      const paint = colour.match(/../g).map(digits => parseInt(digits, 16) / 255);
      return {paint, alive, body: this.boundary(alive), embedded};
    });
    return topology.parts;
  }

  // A nodal field of `width` numbers at the points of an embedded surface.
  blend(number, nodal, width) {
    const carriers = this.arrays[`carriers_${number}`], weights = this.arrays[`weights_${number}`];
    const {least, most} = this.data.embedded[number];
    const hexahedra = this.arrays.hexahedra;
    const blended = new Float32Array(width * carriers.length);
    for (let point = 0; point < carriers.length; ++point) {
      const nodes = hexahedra.subarray(8 * carriers[point], 8 * carriers[point] + 8);
      for (let part = 0; part < width; ++part) {
        const base = nodal[width * nodes[0] + part];
        let sum = base;
        for (let corner = 1; corner < 8; ++corner) {
          const weight = least + weights[7 * point + corner - 1] / 65535 * (most - least);
          sum += weight * (nodal[width * nodes[corner] + part] - base);
        }
        blended[width * point + part] = sum;
      }
    }
    return blended;
  }

  embeddedPoints(number, positions) { return this.blend(number, positions, 3); }

  toolPoints(tool) { return this.placesIn(this.arrays.tools, this.data.toolBox, tool.first, tool.points); }

  // Ends of springs, two of each.
  springEnds({low, high, fraction}) {
    const [from, to] = [low, high].map(state => this.data.states[state].springs);
    if (!from) return null;
    const places = ({first, ends}) => this.placesIn(this.arrays.springs, this.data.springBox, first, ends);
    return from.ends === to?.ends ? blended(places(from), places(to), fraction) : places(from);
  }

  toolSurface(tool, points) {
    const shape = this.shapes[tool.shape];
    if (!shape || shape.faces.length === 0) return null;
    if (!shape.surface) shape.surface = new Surface(points, shape.faces);
    return shape.surface;
  }

  // Where a plane, normal . x = offset, cuts hexahedra: triangles as vertices of seven numbers, and the lines of the
  // mesh.
  cut(alive, positions, fractions, normal, offset) {
    const hexahedra = this.arrays.hexahedra;
    const heights = new Float32Array(this.numNodes);
    for (let node = 0; node < this.numNodes; ++node) heights[node] = dot(normal, pointAt(positions, node)) - offset;
    const vertices = [], lines = [];
    const crossing = (a, b) => {
      const fraction = heights[a] / (heights[a] - heights[b]);
      const place = add(pointAt(positions, a), subtract(pointAt(positions, b), pointAt(positions, a)), fraction);
      const value = fractions[a] < 0 || fractions[b] < 0 ? -1 : fractions[a] + fraction * (fractions[b] - fractions[a]);
      return [...place, ...normal, value];
    };
    const isAbove = node => heights[node] >= 0;
    for (const e of alive) {
      const nodes = hexahedra.subarray(8 * e, 8 * e + 8);
      if (nodes.every(isAbove) || !nodes.some(isAbove)) continue;
      for (const tetrahedron of hexTetrahedra) {
        const above = tetrahedron.map(corner => nodes[corner]).filter(isAbove);
        const below = tetrahedron.map(corner => nodes[corner]).filter(node => !isAbove(node));
        if (above.length === 1 || below.length === 1) {
          const [alone, others] = above.length === 1 ? [above[0], below] : [below[0], above];
          for (const other of others) vertices.push(...crossing(alone, other));
        } else if (above.length === 2) {
          const corners = [[0, 0], [0, 1], [1, 1], [1, 0]].map(([a, b]) => crossing(above[a], below[b]));
          for (const k of [0, 1, 2, 0, 2, 3]) vertices.push(...corners[k]);
        }
      }
      for (const face of hexFaces)
        for (const corners of [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]) {
          const ends = [];
          for (let k = 0; k < 3; ++k) {
            const a = nodes[corners[k]], b = nodes[corners[(k + 1) % 3]];
            if (isAbove(a) !== isAbove(b)) ends.push(crossing(a, b).slice(0, 3));
          }
          if (ends.length === 2) lines.push(...ends[0], ...ends[1]);
        }
    }
    return {vertices: Float32Array.from(vertices), lines: Float32Array.from(lines)};
  }
}
