// ---- gl.js: the little of WebGL2 that the stage needs, without a library.

class Program {
  /** `defines` are names that switch parts of the shaders on. */
  constructor(gl, vertex, fragment, defines = []) {
    this.gl = gl;
    const head = GLSL_HEAD + defines.map((name) => `#define ${name}\n`).join("");
    this.id = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, head + source);
      gl.compileShader(shader);
      gl.attachShader(this.id, shader);
    }
    gl.linkProgram(this.id);
    if (!gl.getProgramParameter(this.id, gl.LINK_STATUS)) {
      const logs = gl.getAttachedShaders(this.id).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error(`a shader does not build: ${[...logs, gl.getProgramInfoLog(this.id)].join(" ")}`);
    }
    this.places = new Map();
  }

  /** Makes the program current and sets uniforms; what the shader does not use is passed over. */
  use(uniforms) {
    const { gl } = this;
    gl.useProgram(this.id);
    for (const [name, value] of Object.entries(uniforms)) this.set(name, value);
  }

  set(name, value) {
    const { gl, places } = this;
    if (!places.has(name)) places.set(name, gl.getUniformLocation(this.id, name));
    const place = places.get(name);
    if (place === null) return;
    if (value instanceof Float32Array && value.length === 16) gl.uniformMatrix4fv(place, false, value);
    else if (Array.isArray(value)) gl[`uniform${value.length}fv`](place, value);
    else if (typeof value === "object") {
      gl.activeTexture(gl.TEXTURE0 + value.slot);
      gl.bindTexture(gl.TEXTURE_2D, value.texture);
      gl.uniform1i(place, value.slot);
    } else if (name.startsWith("n_")) gl.uniform1i(place, value);
    else gl.uniform1f(place, value);
  }
}

/** A texture of floats that is read texel by texel. */
function dataTexture(gl) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const [what, how] of [
    [gl.TEXTURE_MIN_FILTER, gl.NEAREST],
    [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
    [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
  ]) {
    gl.texParameteri(gl.TEXTURE_2D, what, how);
  }
  return texture;
}

/** A row of 256 random bytes, smooth in between: the fibers of a lock. */
function noiseTexture(gl) {
  const random = randomFrom(7);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  const bytes = Uint8Array.from({ length: 256 }, () => 256 * random());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, 256, 1, 0, gl.RED, gl.UNSIGNED_BYTE, bytes);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  return texture;
}

/** Whether WebGL runs on the processor: the picture is made simpler then. */
function rendersInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  let renderer = String(gl.getParameter(gl.RENDERER));
  // Firefox tells; the others tell only if asked like this, of which Firefox would complain.
  if (renderer.startsWith("WebKit")) {
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    if (info) renderer = String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
  }
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}

/** A square depth map that can be asked "is this in the light?", and the target that fills it. */
function shadowMap(gl, size) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, size, size);
  for (const [what, how] of [
    [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
    [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
    [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
    [gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL],
  ]) {
    gl.texParameteri(gl.TEXTURE_2D, what, how);
  }
  const target = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
  gl.drawBuffers([gl.NONE]);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { texture, target, size };
}

/** A vertex array of float attributes that come from one buffer, `sizes` floats each. */
function vertexArray(gl, sizes, data, { divisor = 0, usage = gl.STATIC_DRAW } = {}) {
  const array = gl.createVertexArray();
  const buffer = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  if (data) gl.bufferData(gl.ARRAY_BUFFER, data, usage);
  const stride = 4 * sizes.reduce((a, b) => a + b, 0);
  let offset = 0;
  sizes.forEach((size, place) => {
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(place, divisor);
    offset += 4 * size;
  });
  gl.bindVertexArray(null);
  return { array, buffer };
}

/** Shared by all shaders: one light with a shadow, a sky, and the way to the screen's colors. */
const GLSL_HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DShadow;

// Sharp noise from integers (PCG hash; Jarzynski and Olano 2020), for what differs from hair to hair.
uint hash(uint v) {
  uint state = v * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}
float random(uint a, uint b) { return float(hash(a ^ hash(b)) >> 8u) / 16777216.0; }

// How much of the key light arrives, from 4 places on the shadow map, each smoothed over 2 x 2 texels.
float lit(sampler2DShadow shadow, mat4 light, vec3 p, float bias, float spread) {
  vec3 at = (light * vec4(p, 1.0)).xyz * 0.5 + 0.5;
  float sum = texture(shadow, vec3(at.xy + vec2(-0.4, -1.0) * spread, at.z - bias));
  sum += texture(shadow, vec3(at.xy + vec2(1.0, -0.4) * spread, at.z - bias));
  sum += texture(shadow, vec3(at.xy + vec2(0.4, 1.0) * spread, at.z - bias));
  sum += texture(shadow, vec3(at.xy + vec2(-1.0, 0.4) * spread, at.z - bias));
  return sum * 0.25;
}

// Depth of a place moved 9 mm towards the viewer. The bust is rounded where its shapes meet and has a face; hair
// that lies on the shapes themselves must not sink into that.
float nearer(mat4 camera, vec4 p, vec3 view, float w) {
  vec4 q = camera * vec4(p.xyz + 0.009 * view, 1.0);
  return q.z / q.w * w;
}

// Bright light is rolled off instead of cut, then encoded for the screen.
vec3 shown(vec3 light) {
  vec3 mapped = light * (1.0 + light * 0.12) / (1.0 + light * 0.62);
  return pow(mapped, vec3(1.0 / 2.2));
}
`;
