// Programs of the three-dimensional view: a vertex and a fragment shader each (GLSL ES 3.00).

const SHARED = `#version 300 es
  precision highp float;
  uniform mat4 m; uniform vec4 box; uniform float ex; uniform vec2 size; uniform vec3 pal[8]; uniform float focus;
  vec4 at(vec3 p) { return m * vec4((p.xy - box.xy) * box.w, (p.z - box.z) * box.w * ex, 1.0); }
  float dim(float who) { return focus < 0.0 || who < 0.0 || abs(who - focus) < 0.5 ? 1.0 : 0.22; }`;
const COLOUR = `#version 300 es
  precision highp float; in vec4 colour; out vec4 o; void main() { o = colour; }`;

const SHADERS = {
  terrain: [`
  layout(location=0) in vec3 p; layout(location=1) in vec2 slope;
  out vec3 normal; out float z;
  void main() { gl_Position = at(p); normal = vec3(-slope * ex, 1.0); z = p.z; }`, `#version 300 es
  precision highp float; in vec3 normal; in float z; out vec4 o;
  uniform vec3 low, mid, high, ink; uniform vec3 range;
  void main() {
    float share = clamp((z - range.x) / max(range.y - range.x, 1.0), 0.0, 1.0);
    vec3 tint = share < 0.5 ? mix(low, mid, share * 2.0) : mix(mid, high, share * 2.0 - 1.0);
    vec3 n = normalize(normal);
    float light = dot(n, normalize(vec3(-0.55, 0.5, 0.8)));
    float sky = 0.5 + 0.5 * n.z;
    tint *= 0.34 + 0.30 * sky + 0.50 * max(light, 0.0);
    // Half a decimetre aside, as in the map: heights are whole decimetres, so that no plain lies on a line.
    float line = (z - 0.05) / (range.z > 0.0 ? range.z : 1.0), width = fwidth(line);
    float near = abs(fract(line - 0.5) - 0.5) / max(width, 1e-6);
    float index = abs(fract(line / 5.0 - 0.5) - 0.5) * 5.0 / max(width, 1e-6);
    float drawn = max((1.0 - smoothstep(0.4, 1.3, near)) * 0.16, (1.0 - smoothstep(0.6, 1.7, index)) * 0.26);
    o = vec4(mix(tint, ink, range.z > 0.0 ? drawn * (1.0 - smoothstep(0.25, 0.6, width)) : 0.0), 1.0);
  }`],
  walls: [`
  layout(location=0) in vec3 p; layout(location=1) in vec4 c; out vec4 colour;
  void main() { gl_Position = at(p); colour = c; }`, COLOUR],
  curtains: [`
  layout(location=0) in vec3 a; layout(location=1) in vec3 b; layout(location=2) in vec2 who; uniform float base; out vec4 colour;
  void main() {
    vec3 p = (gl_VertexID & 2) == 0 ? a : b;
    if ((gl_VertexID & 1) == 0) p.z = base;
    gl_Position = at(p); colour = vec4(pal[int(who.x)], 0.17 * dim(who.y));
  }`, COLOUR],
  lines: [`
  layout(location=0) in vec3 a; layout(location=1) in vec3 b; layout(location=2) in vec2 who;
  uniform float width, alpha; uniform vec3 plain; out vec4 colour;
  void main() {
    vec4 A = at(a), B = at(b);
    vec2 along = B.xy / B.w * size - A.xy / A.w * size;
    along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
    float end = (gl_VertexID & 2) == 0 ? -1.0 : 1.0, side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
    vec4 P = end < 0.0 ? A : B;
    P.xy += (vec2(-along.y, along.x) * side + along * end * 0.4) * width / size * P.w;
    P.z -= 0.0012 * P.w;
    gl_Position = P;
    colour = vec4(who.x < 0.0 ? plain : pal[int(who.x)], alpha * dim(who.y));
  }`, COLOUR],
  dots: [`
  layout(location=0) in vec3 p; layout(location=1) in vec2 who; uniform float width; uniform vec3 plain; out vec4 colour; out vec3 eye;
  void main() { gl_Position = at(p); gl_Position.z -= 0.002 * gl_Position.w; gl_PointSize = width;
    colour = vec4(pal[int(who.x)], dim(who.y)); eye = plain; }`, `#version 300 es
  precision highp float; in vec4 colour; in vec3 eye; out vec4 o;
  void main() { float r = length(gl_PointCoord - 0.5) * 2.0; if (r > 1.0) discard; o = r < 0.42 ? vec4(eye, colour.a) : colour; }`],
};
