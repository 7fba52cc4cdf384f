// The graphics card: its programs, and the numbers that they read.

import { CORNER } from "./forms.js";
import { make_programs } from "./shaders.js";

export const MAP = 2048; // texels a side of what the light sees
export const TEXELS = 1024; // of a row of a table

/** Corners of a mesh as the card has them. */
export class Corners {
  /** @param {WebGL2RenderingContext} gl @param {import("./forms.js").Mesh} [mesh] */
  constructor(gl, mesh) {
    this.gl = gl;
    this.array = gl.createVertexArray();
    this.numbers = gl.createBuffer();
    this.colors = gl.createBuffer();
    this.count = 0;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.numbers);
    [
      [3, 0],
      [3, 3],
      [1, 6],
      [1, 7],
      [1, 8],
    ].forEach(([size, from], i) => {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, gl.FLOAT, false, 4 * CORNER, 4 * from);
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colors);
    gl.enableVertexAttribArray(5);
    gl.vertexAttribPointer(5, 4, gl.UNSIGNED_BYTE, true, 0, 0);
    if (mesh) this.fill(mesh);
  }

  /** @param {import("./forms.js").Mesh} mesh */
  fill(mesh) {
    const gl = this.gl,
      colors = new Uint8Array(4 * mesh.count);
    mesh.colors.forEach((c, i) => colors.set([c >> 16, (c >> 8) & 255, c & 255, mesh.round[i] ? 255 : 0], 4 * i));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.numbers);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(mesh.corners), gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.colors);
    gl.bufferData(gl.ARRAY_BUFFER, colors, gl.DYNAMIC_DRAW);
    this.count = mesh.count;
  }

  draw() {
    if (this.count === 0) return;
    this.gl.bindVertexArray(this.array);
    this.gl.drawArrays(this.gl.TRIANGLES, 0, this.count);
  }
}

/** Things drawn once each, by `sizes` numbers an attribute. */
export class Instances {
  /** @param {WebGL2RenderingContext} gl @param {number[]} sizes @param {number[]} [numbers] */
  constructor(gl, sizes, numbers) {
    this.gl = gl;
    this.array = gl.createVertexArray();
    this.numbers = gl.createBuffer();
    this.stride = sizes.reduce((/** @type {number} */ a, /** @type {number} */ b) => a + b, 0);
    this.count = 0;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.numbers);
    let from = 0;
    sizes.forEach((/** @type {number} */ size, /** @type {number} */ i) => {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, gl.FLOAT, false, 4 * this.stride, 4 * from);
      gl.vertexAttribDivisor(i, 1);
      from += size;
    });
    if (numbers) this.fill(numbers);
  }

  /** @param {number[]} numbers */
  fill(numbers) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.numbers);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(numbers), this.gl.DYNAMIC_DRAW);
    this.count = numbers.length / this.stride;
  }

  draw(corners) {
    if (this.count === 0) return;
    this.gl.bindVertexArray(this.array);
    this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, corners, this.count);
  }
}

/** A table of numbers, four to a texel, that shaders read. */
export class Table {
  /** @param {WebGL2RenderingContext} gl @param {Float32Array} [texels] */
  constructor(gl, texels) {
    this.gl = gl;
    this.rows = 1;
    this.texture = texture(gl, gl.RGBA32F, TEXELS, 1, gl.RGBA, gl.FLOAT, gl.NEAREST);
    if (texels) this.fill(gl.TEXTURE2, texels);
  }

  /** Writes whole rows by a unit, to which it is bound then. */
  fill(unit, texels) {
    const { gl } = this,
      rows = texels.length / (4 * TEXELS);
    gl.activeTexture(unit);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (rows === 0) return;
    if (rows > this.rows) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, TEXELS, rows, 0, gl.RGBA, gl.FLOAT, texels);
    else gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TEXELS, rows, gl.RGBA, gl.FLOAT, texels);
    this.rows = Math.max(this.rows, rows);
  }
}

/** Numbers as whole rows of texels, filled up. */
export function as_rows(numbers) {
  const all = new Float32Array(Math.ceil(numbers.length / (4 * TEXELS)) * 4 * TEXELS);
  all.set(numbers);
  return all;
}

export function texture(gl, inner, width, height, format, type, filter) {
  const it = gl.createTexture();
  // a unit that no program reads
  gl.activeTexture(gl.TEXTURE2);
  gl.bindTexture(gl.TEXTURE_2D, it);
  gl.texImage2D(gl.TEXTURE_2D, 0, inner, width, height, 0, format, type, null);
  for (const which of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, which, filter);
  for (const which of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, which, gl.CLAMP_TO_EDGE);
  return it;
}

/** One for all runs of a page. */
export class Card {
  /** None where this browser has no WebGL 2. */
  static made() {
    const canvas = document.createElement("canvas");
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, depth: true, stencil: false, premultipliedAlpha: true });
    return gl && new Card(canvas, gl);
  }

  /** @param {HTMLCanvasElement} canvas @param {WebGL2RenderingContext} gl */
  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    this.programs = make_programs(gl);
    this.map = texture(gl, gl.DEPTH_COMPONENT24, MAP, MAP, gl.DEPTH_COMPONENT, gl.UNSIGNED_INT, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL);
    this.map_frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.map_frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.map, 0);
    gl.drawBuffers([gl.NONE]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    /** @type {{color: WebGLTexture, depth: WebGLRenderbuffer, frame: WebGLFramebuffer, width: number, height: number} | null} */
    this.ground = null;
  }

  /** Sets the size of its picture, px. */
  size(width, height) {
    if (this.canvas.width === width && this.canvas.height === height) return;
    this.canvas.width = width;
    this.canvas.height = height;
    if (!this.ground) return;
    this.gl.deleteTexture(this.ground.color);
    this.gl.deleteRenderbuffer(this.ground.depth);
    this.gl.deleteFramebuffer(this.ground.frame);
    this.ground = null;
  }

  /** Where the ground's shadow is added up, half as large as the picture. */
  shade() {
    if (this.ground) return this.ground;
    const { gl, canvas } = this,
      width = (canvas.width + 1) >> 1,
      height = (canvas.height + 1) >> 1;
    const color = texture(gl, gl.RGBA8, width, height, gl.RGBA, gl.UNSIGNED_BYTE, gl.LINEAR),
      frame = gl.createFramebuffer();
    const depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, color, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    return (this.ground = { color, depth, frame, width, height });
  }
}
