// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// @file
/// Shaders of the painter of scenes (paint3_gl.cpp, which explains them). Private to render.

namespace lagrain::detail::shaders3 {

// Sizes that the shaders and the painter have to agree on.
inline constexpr int kMapSize = 512;       // side of a shadow map [texels]
inline constexpr int kBodiesPerRow = 512;  // of the table of bodies
inline constexpr int kMostCuts = 8;
inline constexpr int kMostLights = 9;  // in one sub-frame, the sun among them

// The view of a camera or of a light, with which all shaders of bodies and of light begin.
inline constexpr const char* kView = R"(
uniform mat3 axes;         // rows: right, up, towards the viewer
uniform vec3 shift;        // the scene's middle, seen from the eye along these axes
uniform vec2 half_size;    // of the picture; perspective: at depth 1
uniform vec2 jitter;       // of the picture, where 2 is its size
uniform float perspective; // 0 or 1
uniform vec2 range;        // least depth, extent
uniform vec4 window;       // x, y, width, height in pixels
#define DEPTH(t) clamp(((t) - range.x) / range.y, 0.0, 1.0)
// The point o + t d of the line of sight through a pixel has the depth t.
void sight(vec2 pixel, out vec3 o, out vec3 d) {
  vec2 q = (2.0 * (pixel - window.xy) / window.zw - 1.0 - jitter) * half_size;
  o = vec3((1.0 - perspective) * q, 0.0);
  d = vec3(perspective * q, -1.0);
}
)";

inline constexpr const char* kBodyVertexShader = R"(
layout(location = 0) in vec4 from_radius;
layout(location = 1) in vec4 to_id;
flat out vec3 a, b;
flat out float radius, id;
// Middle and radius of the smallest disc around a ball in the picture.
vec3 around(vec3 c) {
  if (perspective == 0.0) return vec3(c.xy, radius);
  float square = c.z * c.z - radius * radius;
  return vec3(-c.z * c.xy, radius * sqrt(dot(c, c) - radius * radius)) / square;
}
void main() {
  a = axes * from_radius.xyz + shift;
  b = axes * to_id.xyz + shift;
  radius = from_radius.w;
  id = to_id.w;
  // A rectangle along the body that holds the discs at its ends.
  vec3 one = around(a), other = around(b);
  vec2 along = other.xy - one.xy;
  float len = length(along);
  along = len > 1e-7 ? along / len : vec2(1.0, 0.0);
  float reach = max(one.z, other.z);
  vec2 corner = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
  vec2 p = 0.5 * (one.xy + other.xy) + corner.x * (0.5 * len + reach) * along +
           corner.y * reach * vec2(-along.y, along.x);
  gl_Position = vec4(p / half_size + jitter, 0.0, 1.0);
}
)";

// Draws a ball that no cut touches.
inline constexpr const char* kBallFragmentShader = R"(
flat in vec3 a;
flat in float radius, id;
out float seen;
void main() {
  vec3 o, d;
  sight(gl_FragCoord.xy, o, d);
  float along = dot(d, d), t = dot(a - o, d) / along;
  vec3 aside = o + t * d - a;
  float inside = radius * radius - dot(aside, aside);
  if (inside < 0.0) discard;
  gl_FragDepth = DEPTH(t - sqrt(inside / along));
  seen = id;
}
)";

// Draws the shadow of a ball that no cut touches. Lights see along parallel lines.
inline constexpr const char* kBallShadowVertexShader = R"(
layout(location = 0) in vec4 from_radius;
out vec2 local;
void main() {
  vec3 c = axes * from_radius.xyz + shift;
  local = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
  gl_Position = vec4((c.xy + from_radius.w * local) / half_size + jitter,
                     2.0 * DEPTH(-c.z) - 1.0, 1.0);
}
)";

inline constexpr const char* kBallShadowFragmentShader = R"(
in vec2 local;
void main() {
  if (dot(local, local) > 1.0) discard;
}
)";

// Draws a tube, or a ball that is cut: the ray's stretch inside the hull of two balls, then inside
// the half-spaces that the cuts leave. With SHADOW the depth is that of the stretch's middle,
// without it that of its beginning.
inline constexpr const char* kBodyFragmentShader = R"(
flat in vec3 a, b;
flat in float radius, id;
uniform vec4 cuts[MOST_CUTS];
uniform int cut_count;
#ifndef SHADOW
out float seen;
#endif
void ball(vec3 o, vec3 d, vec3 c, inout vec2 stretch) {
  float along = dot(d, d), t = dot(c - o, d) / along;
  vec3 aside = o + t * d - c;
  float inside = radius * radius - dot(aside, aside);
  if (inside < 0.0) return;
  float h = sqrt(inside / along);
  stretch = vec2(min(stretch.x, t - h), max(stretch.y, t + h));
}
void cylinder(vec3 o, vec3 d, inout vec2 stretch) {
  float len = distance(a, b);
  if (len < 1e-6) return;
  vec3 u = (b - a) / len;
  float o_along = dot(o - a, u), d_along = dot(d, u);
  vec3 o_aside = o - a - o_along * u, d_aside = d - d_along * u;
  float dd = dot(d_aside, d_aside);
  if (dd < 1e-10) return;
  float t = -dot(o_aside, d_aside) / dd;
  vec3 nearest = o_aside + t * d_aside;
  float inside = radius * radius - dot(nearest, nearest);
  if (inside < 0.0) return;
  float h = sqrt(inside / dd);
  vec2 part = vec2(t - h, t + h);
  float step = abs(d_along) > 1e-7 ? d_along : 1e-7;
  vec2 ends = (vec2(0.0, len) - o_along) / step;
  part = vec2(max(part.x, min(ends.x, ends.y)), min(part.y, max(ends.x, ends.y)));
  if (part.x < part.y) stretch = vec2(min(stretch.x, part.x), max(stretch.y, part.y));
}
void main() {
  vec3 o, d;
  sight(gl_FragCoord.xy, o, d);
  float near = -0.5 * (a.z + b.z);  // start beside the body, for the sake of precision
  o += near * d;
  vec2 stretch = vec2(1e9, -1e9);
  ball(o, d, a, stretch);
  ball(o, d, b, stretch);
  cylinder(o, d, stretch);
  for (int k = 0; k < cut_count; ++k) {
    float rate = dot(cuts[k].xyz, d), left = cuts[k].w - dot(cuts[k].xyz, o);
    float t = left / (abs(rate) > 1e-9 ? rate : 1e-9);
    if (rate > 0.0) stretch.y = min(stretch.y, t); else stretch.x = max(stretch.x, t);
  }
  if (stretch.x > stretch.y) discard;
#ifdef SHADOW
  gl_FragDepth = DEPTH(near + 0.5 * (stretch.x + stretch.y));
#else
  gl_FragDepth = DEPTH(near + stretch.x);
  seen = id;
#endif
}
)";

// Draws a line of constant width in the picture.
inline constexpr const char* kLineVertexShader = R"(
layout(location = 0) in vec4 from_radius;
layout(location = 1) in vec4 to_id;
flat out float id;
out float reach;  // depth, perspective: its inverse; both are linear in the picture
void main() {
  vec3 a = axes * from_radius.xyz + shift, b = axes * to_id.xyz + shift;
  vec2 depth = -vec2(a.z, b.z);
  vec2 scale = perspective > 0.0 ? 1.0 / depth : vec2(1.0);
  vec2 pa = 0.5 * window.zw * (a.xy * scale.x / half_size + jitter);
  vec2 pb = 0.5 * window.zw * (b.xy * scale.y / half_size + jitter);
  vec2 along = pb - pa;
  float len = max(length(along), 1e-6), half_width = from_radius.w;
  along /= len;
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  float s = mix(-half_width, len + half_width, corner.x);
  vec2 p = pa + s * along + (2.0 * corner.y - 1.0) * half_width * vec2(-along.y, along.x);
  vec2 ends = perspective > 0.0 ? scale : depth;
  reach = mix(ends.x, ends.y, s / len);
  id = to_id.w;
  gl_Position = vec4(2.0 * p / window.zw, 0.0, 1.0);
}
)";

inline constexpr const char* kLineFragmentShader = R"(
flat in float id;
in float reach;
out float seen;
void main() {
  gl_FragDepth = DEPTH(perspective > 0.0 ? 1.0 / reach : reach);
  seen = id;
}
)";

// Finds again the point that is seen through a pixel, and adds up the light on it.
inline constexpr const char* kLightFragmentShader = R"(
uniform sampler2D ids, depths;     // what is seen through each pixel
uniform sampler2D bodies;          // three texels a body: end and radius, end and half a line's
                                   // pixels, colour and whether it is lit
uniform sampler2D panes;           // plane, four sides, colour; a row a pane, the farthest first
uniform int pane_count;
uniform sampler2D shadows;         // square maps side by side
uniform int lights;                // the first is the sun
uniform vec3 light_axes[3 * MOST_LIGHTS];  // right, up, towards the light
uniform float strength[MOST_LIGHTS];
uniform float map_reach;
uniform vec2 map_jitter;
uniform vec4 ground;               // normal, height
uniform int has_ground;
uniform vec4 outline;              // colour, opacity
uniform int outline_pixels;
uniform float weight;
out vec4 colour;

const float kAmbient = 0.09;   // light that no shadow takes away
const float kShine = 0.16;     // strength of the sun's reflection (Blinn, SIGGRAPH 1977)
const float kSharpness = 48.0; // and its exponent
const float kGround = 0.75;    // how black the floor's deepest shadow is
// The floor takes only half of the sky's light: a haze that reaches far beyond the bodies would
// show where the picture ends.
const float kGroundSky = 0.5;
const float kCutFace = 0.70;   // brightness of the faces that cuts leave

// Where light k sees p: texels of its map, and depth. Behind the map's range something may still be
// in the way, therefore depth is kept inside.
vec3 seen_by(int k, vec3 p) {
  vec3 q = vec3(dot(light_axes[3 * k], p), dot(light_axes[3 * k + 1], p),
                -dot(light_axes[3 * k + 2], p)) / map_reach;
  q.xy = float(MAP_SIZE) * (0.5 * (q.xy + map_jitter) + 0.5);
  return vec3(q.xy, min(0.5 * q.z + 0.5, 0.99999));
}

// Tells whether light k reaches a point: outside the map nothing is in the way. Fetching texels
// costs half of what the texture unit's comparison does in software.
float reaches(int k, ivec2 texel, float depth) {
  bool outside = min(texel.x, texel.y) < 0 || max(texel.x, texel.y) >= MAP_SIZE;
  texel = clamp(texel, 0, MAP_SIZE - 1) + ivec2(MAP_SIZE * k, 0);
  return outside || depth <= texelFetch(shadows, texel, 0).r ? 1.0 : 0.0;
}

float sky_light(int k, vec3 p) {
  vec3 q = seen_by(k, p);
  return reaches(k, ivec2(floor(q.xy)), q.z);
}

// The sun's shadows have few steps from one sub-frame to the next; between texels they are blended.
float sun_light(vec3 p) {
  vec3 q = seen_by(0, p);
  vec2 at = q.xy - 0.5, part = fract(at);
  ivec2 texel = ivec2(floor(at));
  vec2 below = vec2(reaches(0, texel, q.z), reaches(0, texel + ivec2(1, 0), q.z)),
       above = vec2(reaches(0, texel + ivec2(0, 1), q.z), reaches(0, texel + ivec2(1, 1), q.z));
  vec2 both = mix(below, above, part.y);
  return mix(both.x, both.y, part.x);
}

vec4 body(int id, int part) {
  return texelFetch(bodies, ivec2(id % BODIES_PER_ROW * 3 + part, id / BODIES_PER_ROW), 0);
}

// How much nearer than a line a plane that holds it may be at this pixel, which lies `aside` of the
// line's axis at most; bodies have no width aside.
float slack(vec3 normal, vec3 d, float aside) {
  float c = abs(dot(normal, normalize(d)));
  return 1e-4 + aside * sqrt(max(1.0 - c * c, 0.0)) / max(c, 0.01);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float seen = texelFetch(ids, at, 0).r, z = texelFetch(depths, at, 0).r;
  vec3 o, d;
  sight(gl_FragCoord.xy, o, d);
  o = (o - shift) * axes;
  d = d * axes;
  float t = seen >= 0.0 ? range.x + z * range.y : 1e9;

  int id = int(max(seen, 0.0));
  vec4 paint = body(id, 2);
  float aside = 0.0;
  if (seen >= 0.0 && paint.w == 0.0) {
    float pixel = 2.0 * half_size.y / window.w * mix(1.0, t, perspective);
    aside = (body(id, 1).w + 1.0) * pixel;
  }
  bool on_ground = false;
  if (has_ground == 1) {
    float towards = dot(ground.xyz, d);
    float to_ground = (ground.w - dot(ground.xyz, o)) / towards;
    on_ground = towards < 0.0 && to_ground > 0.0 && to_ground < t - slack(ground.xyz, d, aside);
    if (on_ground) t = to_ground;
  }
  bool solid = seen >= 0.0 && !on_ground;
  vec3 p = o + t * d, n = ground.xyz;
  float radius = 0.0;
  bool flat_face = false;
  if (solid) {
    vec4 a = body(id, 0);
    vec3 along = body(id, 1).xyz - a.xyz;
    radius = a.w;
    n = p - a.xyz - clamp(dot(p - a.xyz, along) / max(dot(along, along), 1e-12), 0.0, 1.0) * along;
    // Cuts leave flat faces inside the body's surface; the surface itself is found up to rounding.
    flat_face = length(n) < 0.998 * radius - 1e-6;
    n = normalize(n);
  }

  float light = 0.0, all = 0.0, shine = 0.0;
  if (on_ground || (solid && paint.w > 0.0)) {
    vec3 to_eye = -normalize(d);
    all = strength[0] * max(dot(n, light_axes[2]), 0.0);
    float sun = sun_light(p);
    light = all * sun;
    vec3 half_way = normalize(light_axes[2] + to_eye);
    if (all > 0.0) shine = sun * pow(max(dot(n, half_way), 0.0), kSharpness);
    for (int k = 1; k < lights; ++k) {
      float full = strength[k] * max(dot(n, light_axes[3 * k + 2]), 0.0);
      if (on_ground) full *= kGroundSky;
      light += full * sky_light(k, p);
      all += full;
    }
  }
  vec4 sum = vec4(0.0);
  if (on_ground) sum.a = all > 0.0 ? kGround * (1.0 - light / all) : 0.0;
  if (solid) {
    sum = vec4(paint.rgb, 1.0);
    if (flat_face) {
      sum.rgb *= kCutFace;
    } else if (paint.w > 0.0) {
      sum.rgb = sum.rgb * (kAmbient + light) + kShine * shine;
    }
    if (paint.w > 0.0 && outline.a > 0.0) {
      ivec2 last = textureSize(ids, 0) - 1;
      float step = 0.0;
      for (int k = 0; k < 4; ++k) {
        ivec2 aside = (k & 1) == 0 ? ivec2((k & 2) - 1, 0) : ivec2(0, (k & 2) - 1);
        ivec2 beside = clamp(at + outline_pixels * aside, ivec2(0), last);
        float other = texelFetch(ids, beside, 0).r;
        float behind = range.x + texelFetch(depths, beside, 0).r * range.y - t;
        if (other < 0.0) behind = 1e9;
        // A step in depth of less than a tenth of the radius has no outline.
        if (other != seen) step = max(step, smoothstep(0.1, 0.6, behind / radius));
      }
      sum.rgb = mix(sum.rgb, outline.rgb, outline.a * step);
    }
  }

  for (int k = 0; k < pane_count; ++k) {
    vec4 plane = texelFetch(panes, ivec2(0, k), 0), tint = texelFetch(panes, ivec2(5, k), 0);
    float to_pane = (plane.w - dot(plane.xyz, o)) / dot(plane.xyz, d);
    vec3 x = o + to_pane * d;
    bool inside = to_pane > 0.0 && to_pane < t - slack(plane.xyz, d, aside);
    for (int side = 1; side <= 4; ++side) {
      vec4 edge = texelFetch(panes, ivec2(side, k), 0);
      inside = inside && dot(edge.xyz, x) <= edge.w;
    }
    if (inside) sum = vec4(tint.rgb, 1.0) * tint.a + (1.0 - tint.a) * sum;
  }
  colour = weight * sum;
}
)";

// Turns the sum of light into sRGB, on the background.
inline constexpr const char* kDevelopFragmentShader = R"(#version 330 core
uniform sampler2D sum;
uniform vec4 background;
out vec4 colour;
void main() {
  vec4 c = texelFetch(sum, ivec2(gl_FragCoord.xy), 0);
  c += (1.0 - c.a) * vec4(background.rgb, 1.0) * background.a;
  vec3 light = clamp(c.rgb / max(c.a, 1e-6), 0.0, 1.0);
  vec3 encoded = mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055,
                     step(0.0031308, light));
  colour = vec4(encoded, 1.0) * c.a;
}
)";

}  // namespace lagrain::detail::shaders3
