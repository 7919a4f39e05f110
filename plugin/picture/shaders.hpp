// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast::output {

// Texts of the programs that painters draw with. Their constants stand in painter.cpp, the light in ink.hpp.

inline constexpr const char* kVersion = "#version 330 core\n";

// What lies outside is left out.
inline constexpr const char* kClip = R"(
uniform vec4 cut;       // normal, offset: what lies above
uniform vec3 low, high; // of a box
out float gl_ClipDistance[7];
void leave_out(vec3 place) {
  gl_ClipDistance[0] = cut.w - dot(cut.xyz, place);
  for (int k = 0; k < 3; ++k) {
    gl_ClipDistance[1 + k] = place[k] - low[k];
    gl_ClipDistance[4 + k] = high[k] - place[k];
  }
}
)";
inline constexpr int kNumClips = 7;

// How a surface is lit: by what its vertices receive of the light, or at every pixel by the main lamp and the even sky.
// Places are seen along right, up and towards the viewer, around the middle of the bodies, which reach to 1.
inline constexpr const char* kShading = R"(
uniform sampler2DShadow shadow;
uniform mat3 lamp;
uniform vec4 eye;  // homogeneous
uniform int lighting;

const vec2 kDisc[12] = vec2[](vec2(-0.33, -0.40), vec2(-0.84, -0.07), vec2(-0.70, 0.46), vec2(-0.20, 0.62),
                              vec2(0.96, -0.19), vec2(0.47, -0.48), vec2(0.52, 0.77), vec2(0.19, -0.89),
                              vec2(0.51, 0.06), vec2(0.90, 0.41), vec2(-0.32, -0.93), vec2(-0.79, -0.60));

float received(vec3 place, vec3 normal) {
  vec3 at = 0.5 + 0.5 * (lamp * (place + kLift * normal));
  float arriving = 0;
  for (int tap = 0; tap < 12; ++tap) arriving += texture(shadow, vec3(at.xy + kSoft * kDisc[tap], 1 - at.z - kSlack));
  return sky(normal) + kStrength * max((lamp * normal).z, 0) * arriving / 12;
}

// What multiplies the colour, and what is added.
vec2 shaded(vec3 place, vec3 outwards, float light) {
  if (lighting == 0) return vec2(1, 0);
  if (lighting == 2) return vec2(lit_thing(vec3(1), normalize(outwards)).r, 0);
  vec3 sight = normalize(eye.xyz - eye.w * place);
  vec3 normal = normalize(dot(outwards, sight) < 0 ? -outwards : outwards);
  if (!kIsLit) light = received(place, normal);
  float gleam = moist(vec3(0), normal, sight, light).r;
  return vec2(moist(vec3(1), normal, sight, light).r - gleam, gleam);
}
)";

inline constexpr const char* kSurfaceVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
layout(location = 3) in float light;
uniform mat4 clip, seen;
uniform vec2 scale;  // min, 1 / (max - min)
uniform float grow;  // along the normal
out vec3 seen_place, seen_normal;
out vec2 shading;
out float fraction, gap;
void main() {
  gl_Position = clip * vec4(place + grow * normal, 1);
  leave_out(place);
  seen_place = (seen * vec4(place, 1)).xyz;
  seen_normal = mat3(seen) * normal;
  if (kIsLit) shading = shaded(seen_place, seen_normal, light);
  gap = abs(value) < 1e38 ? 0.0 : 1.0;
  fraction = gap > 0 ? 0.0 : (value - scale.x) * scale.y;
})";

inline constexpr const char* kSurfaceFragment = R"(
in vec3 seen_place, seen_normal;
in vec2 shading;
in float fraction, gap;
uniform sampler2D colours;
uniform vec4 paint;  // over the scale, as far as its alpha says
uniform vec3 no_value;
uniform float opacity;
out vec4 colour;
void main() {
  vec3 base = mix(texture(colours, vec2(fraction, 0.5)).rgb, no_value, gap);
  vec2 shade = kIsLit ? shading : shaded(seen_place, seen_normal, 1.0);
  colour = vec4(mix(base, paint.rgb, paint.a) * shade.x + shade.y, opacity);
})";

inline constexpr const char* kFlatVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 ink;
uniform mat4 clip;
uniform float nearer;  // pulled towards the viewer by this much of the depth
uniform float point_size;
out vec4 paint;
void main() {
  gl_Position = clip * vec4(place, 1);
  leave_out(place);
  gl_Position.z -= nearer * gl_Position.w;
  gl_PointSize = point_size;
  paint = ink;
})";

inline constexpr const char* kFlatFragment = R"(
in vec4 paint;
uniform bool is_round;
uniform float point_size;
out vec4 colour;
void main() {
  colour = paint;
  if (is_round) colour.a *= clamp(point_size * (0.5 - length(gl_PointCoord - 0.5)), 0, 1);
})";

}  // namespace hexaplast::output
