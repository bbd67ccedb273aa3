// SPDX-License-Identifier: Apache-2.0
// The shaders that draw ellipsoids, to be put in the places of VTK's shader templates.
//
// A body is c + A s, |s| <= 1. In the space of s it is the unit sphere, and the eye is at e = A^-1 (eye - c). With k = 1 /
// |e|, n = k e, r = sqrt(1 - k^2) and u, v that make an orthonormal basis of n, view rays touch the sphere in the circle
// r (u cos p + v sin p) + k n. So what a triangle around the unit circle of (a, b) covers as r (a u + b v) + k n, turned into
// space by A, is all of the body; the ray to its point (a, b) meets the sphere where a^2 + b^2 <= 1, at the points
//     (r a, r b, k +- h) / (1 +- k h)    in the basis u, v, n,    h = sqrt(1 - a^2 - b^2).
// Proof: the ray e + t (q - e), with q = r (a u + b v) + k n, has |q - e|^2 = r^2 (a^2 + b^2 + r^2 / k^2); it is on the sphere
// at t = 1 / (1 +- k h). Rays of a parallel view are the limit k = 0. Nothing cancels where a body is thin, far or seen at its
// edge. If the eye is within (|e| < 1, in perspective), the triangle covers the picture, and e + t d is solved for t > 0.
#pragma once

namespace anamorph_vtk {

/// The number of texels that a body takes of the buffer `bodies`: the centre, as the sum of two floats a
/// coordinate (its w: 1, or 0 if it is not to be drawn; the other w: 1 + the number of its texture, 0 without
/// one); the columns of A (the first two w: its cell's id, as id % 2^24 and id / 2^24); the rows of A^-1 (the
/// first two w: the texture's offset in texels); the colour.
constexpr int kBodyTexels = 9;

/// Draws 3 vertices, a triangle, for each body.
constexpr const char* kEllipsoidVertexShader = R"glsl(//VTK::System::Dec
uniform samplerBuffer bodies;
uniform int firstBody;
uniform int textureDrawn;  // only bodies with this one; -1: all
uniform int eyeInPerspective;
uniform vec3 eyeHigh, eyeLow;  // of the eye, as centres are given
uniform vec3 towardEye;        // of parallel views
uniform mat3 bodyToView, viewToBody;
uniform mat4 viewToClip, clipToView;

out vec3 at;
flat out vec4 apex;
flat out vec3 center;
flat out mat3 axes, inverseAxes, basis;
flat out vec4 bodyColor;
flat out ivec2 bodyIds;
flat out vec2 bodyOffset;
//VTK::CustomUniforms::Dec

void main()
{
  int body = gl_VertexID / 3, corner = gl_VertexID % 3;
  vec2 ab = corner == 0 ? vec2(-1.7320509, -1.0) : corner == 1 ? vec2(1.7320509, -1.0) : vec2(0.0, 2.0);
  int texel = (firstBody + body) * BODY_TEXELS;
  vec4 high = texelFetch(bodies, texel), low = texelFetch(bodies, texel + 1);
  vec4 x = texelFetch(bodies, texel + 2), y = texelFetch(bodies, texel + 3), z = texelFetch(bodies, texel + 4);
  mat3 A = mat3(x.xyz, y.xyz, z.xyz);
  vec4 row = texelFetch(bodies, texel + 5), secondRow = texelFetch(bodies, texel + 6);
  mat3 inverseA = transpose(mat3(row.xyz, secondRow.xyz, texelFetch(bodies, texel + 7).xyz));
  bodyOffset = vec2(row.w, secondRow.w);
  bodyColor = texelFetch(bodies, texel + 8);
  bodyIds = ivec2(body, int(x.w) + 16777216 * int(y.w));
  vec3 fromEye = (high.xyz - eyeHigh) + (low.xyz - eyeLow);
  center = bodyToView * fromEye;

  vec3 e = eyeInPerspective == 1 ? inverseA * -fromEye : inverseA * towardEye;
  float s = length(e);
  bool inside = eyeInPerspective == 1 && s <= 1.0;
  float k = eyeInPerspective == 1 ? 1.0 / s : 0.0;
  float r = eyeInPerspective == 1 ? sqrt(max(0.0, (s - 1.0) * (s + 1.0))) * k : 1.0;
  vec3 n = e / s;
  vec3 u = normalize(abs(n.x) < 0.6 ? vec3(0.0, -n.z, n.y) : vec3(n.z, 0.0, -n.x));
  basis = inside ? mat3(1.0) : mat3(u, cross(n, u), n);
  axes = bodyToView * A * basis;
  inverseAxes = transpose(basis) * inverseA * viewToBody;
  apex = inside ? vec4(e, 1.0) : vec4(k, r, 0.0, 0.0);
  if (inside)
  {
    gl_Position = vec4(2.0 * ab, 0.0, 1.0);
    vec4 ray = clipToView * gl_Position;
    at = inverseAxes * (ray.xyz / ray.w);
  }
  else
  {
    at = vec3(ab, 0.0);
    vec4 clip = viewToClip * vec4(center + axes * vec3(r * ab, k), 1.0);
    gl_Position = vec4(clip.xy, 0.0, clip.w);  // the depth is that of the surface
  }
  if (high.w == 0.0 || (textureDrawn >= 0 && int(low.w) != textureDrawn)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
)glsl";

/// Declarations of the fragment shader, with CUT 1 for bodies that the eye may be in, or a plane may cut.
constexpr const char* kEllipsoidDeclarations = R"glsl(
uniform mat4 viewToClip;
uniform float depthBias;
uniform int farSide;  // 1: what leaves is drawn, not what enters
in vec3 at;
flat in vec4 apex;
flat in vec3 center;
flat in mat3 axes, inverseAxes, basis;
flat in vec4 bodyColor;
flat in ivec2 bodyIds;
flat in vec2 bodyOffset;

// Where the ray enters (side 1) or leaves (side -1) the sphere, in its basis.
vec3 spherePoint(float side)
{
#if CUT
  if (apex.w == 1.0)
  {
    float a = dot(at, at), b = dot(apex.xyz, at), c = 1.0 - dot(apex.xyz, apex.xyz), root = sqrt(b * b + a * c);
    return apex.xyz + at * (b > 0.0 ? c / (b + root) : (root - b) / a);
  }
#endif
  float k = apex.x, r = apex.y, h = side * sqrt(max(0.0, 1.0 - dot(at.xy, at.xy)));
  return vec3(r * at.xy, k + h) / (1.0 + k * h);
}

float depthOf(vec3 p)
{
  vec4 clip = viewToClip * vec4(p, 1.0);
  return clip.z / clip.w;
}

#if CUT
uniform int numberOfClips;
uniform vec4 clips[6];

bool isCut(vec3 p)
{
  for (int i = 0; i < numberOfClips; ++i)
    if (dot(clips[i], vec4(p, 1.0)) < 0.0) return true;
  vec4 clip = viewToClip * vec4(p, 1.0);
  return clip.z < -clip.w || clip.w <= 0.0;
}
#endif
//VTK::PositionVC::Dec)glsl";

/// Finds the first point of the ray that is not cut off; the far side shows where the near one is.
constexpr const char* kEllipsoidPosition = R"glsl(
  float side = farSide == 1 ? -1.0 : 1.0;
  vec3 s = spherePoint(side);
  vec4 vertexVC = vec4(center + axes * s, 1.0);
  bool seen = dot(at.xy, at.xy) <= 1.0;
#if CUT
  if (apex.w == 1.0) seen = true;
  if (apex.w == 1.0 || isCut(vertexVC.xyz))
  {
    side = -1.0;
    s = spherePoint(side);
    vertexVC.xyz = center + axes * s;
    seen = seen && !isCut(vertexVC.xyz);
  }
#endif
//STYLE
  float depth = depthOf(vertexVC.xyz);
)glsl";

/// Finds the face of the octant that looks toward the eye behind its surface, and whether there is ink: on lines 2 pixels wide where
/// principal planes meet the surface, and on hatches of a face, at each fifth of an axis. The ray goes on in the direction
/// k s - n in the basis (times 1 / k it is s - e), and leaves the octant where the first of its three planes is passed; if that is beyond the
/// sphere, it has missed the body.
constexpr const char* kEllipsoidStyle = R"glsl(
  vec3 own = basis * s;
  vec3 ownSize = max(vec3(length(vec2(dFdx(own.x), dFdy(own.x))), length(vec2(dFdx(own.y), dFdy(own.y))),
                          length(vec2(dFdx(own.z), dFdy(own.z)))), vec3(1e-20));
  vec3 pixels = abs(own) / ownSize;
  float ink = min(pixels.x, min(pixels.y, pixels.z)) < 1.0 ? 0.0 : 1.0;
#if OCTANT
  vec3 octantSide = vec3(basis[2].x < 0.0 ? -1.0 : 1.0, basis[2].y < 0.0 ? -1.0 : 1.0, basis[2].z < 0.0 ? -1.0 : 1.0);
  int octantFace = -1;
  vec3 cut = own;
  if (apex.w == 0.0 && side > 0.0 && all(greaterThan(own * octantSide, vec3(0.0))))
  {
    vec3 way = basis * (apex.x * s - vec3(0.0, 0.0, 1.0));
    float passed = 1e30;
    for (int i = 0; i < 3; ++i)
    {
      float t = -own[i] / way[i];
      if (way[i] * octantSide[i] < 0.0 && t < passed)
      {
        passed = t;
        octantFace = i;
      }
    }
    cut = own + passed * way;
    seen = seen && octantFace >= 0 && dot(cut, cut) <= 1.0;
    if (octantFace >= 0) cut[octantFace] = 0.0;
    s = cut * basis;
    vertexVC = vec4(center + axes * s, 1.0);
  }
  // Derivatives are those of all pixels around, wherever they lie.
  float hatch = 5.0 * cut[octantFace == 2 ? 0 : octantFace + 1], step = max(length(vec2(dFdx(hatch), dFdy(hatch))), 1e-20);
  if (octantFace >= 0) ink = abs(hatch - floor(hatch + 0.5)) < step ? 0.0 : 1.0;
#endif
)glsl";

/// The normal of a face is that of a principal plane; the transform that normals have takes it along.
constexpr const char* kEllipsoidFaceNormal = R"glsl(
  if (octantFace >= 0)
  {
    vec3 plane = vec3(0.0);
    plane[octantFace] = octantSide[octantFace];
    normalVCVSOutput = normalize((plane * basis) * inverseAxes);
    coatNormalVCVSOutput = normalVCVSOutput;
  }
)glsl";

constexpr const char* kEllipsoidDepth = R"glsl(
  if (!seen || depth > 1.0) discard;
  gl_FragDepth = 0.5 * (gl_DepthRange.diff * depth + gl_DepthRange.near + gl_DepthRange.far) - depthBias;
)glsl";

/// Computes texture coordinates as vtkAnamorphFigureGeometry has them. Across the cut behind they change by
/// little, not by 1.
constexpr const char* kEllipsoidTexture = R"glsl(
  vec3 own = basis * s;
  vec2 uv = vec2(0.5 - atan(own.x, -own.z) * 0.15915494, 0.5 + atan(own.y, length(own.xz)) * 0.31830989);
  vec2 uvAcross = dFdx(uv), uvUp = dFdy(uv);
  uvAcross.x -= floor(uvAcross.x + 0.5);
  uvUp.x -= floor(uvUp.x + 0.5);
)glsl";

/// Reads the texel of the texture of a body, (u, v) as the core's body_mapping.h has them. What lies beyond
/// the texture's edges goes on as the mapping does: LATLONG over the poles and around, which takes a texture
/// that repeats; MIRRORED; or as at the edge.
constexpr const char* kBodyTexture = R"glsl(
uniform sampler2D bodyTexture;
uniform int bodyTextureChannels;  // 0: none
uniform int bodyTextureMultiplied;  // by alpha

vec4 bodyTexel(vec2 uv, vec2 across, vec2 up)
{
  vec2 size = vec2(textureSize(bodyTexture, 0)), flip = vec2(1.0, -1.0);
  uv += bodyOffset / size;
#if LATLONG
  uv.y -= 2.0 * floor(0.5 * uv.y);
  if (uv.y > 1.0) uv = vec2(uv.x + 0.5, 2.0 - uv.y);
  uv.y = clamp(uv.y, 0.5 / size.y, 1.0 - 0.5 / size.y);
#else
#if MIRRORED
  uv = 1.0 - abs(uv - 2.0 * floor(0.5 * uv) - 1.0);
#endif
  uv = clamp(uv, 0.5 / size, 1.0 - 0.5 / size);
#endif
  vec4 texel = textureGrad(bodyTexture, vec2(uv.x, 1.0 - uv.y), flip * across, flip * up);
  return bodyTextureChannels == 1 ? texel.rrra : bodyTextureChannels == 2 ? texel.rrrg : texel;
}
)glsl";

/// Computes texture coordinates in NUDES' space, where z is negated.
constexpr const char* kBodyTextureCoordinates = R"glsl(
  vec3 bodyPoint = vec3(1.0, 1.0, -1.0) * (basis * s);
  vec2 bodyUv, bodyUvAcross, bodyUvUp;
  bodyMapping(bodyPoint, dFdx(bodyPoint), dFdy(bodyPoint), bodyUv, bodyUvAcross, bodyUvUp);
)glsl";

/// Lays the texture over the body's own colour where it is transparent.
constexpr const char* kBodyTextureColor = R"glsl(
  if (bodyTextureChannels > 0)
  {
    vec4 texel = bodyTexel(bodyUv, bodyUvAcross, bodyUvUp);
    vec3 color = mix(bodyColor.rgb, bodyTextureMultiplied == 1 ? texel.rgb / max(texel.a, 1e-6) : texel.rgb, texel.a);
    ambientColor = ambientIntensity * color;
    diffuseColor = diffuseIntensity * color;
  }
)glsl";

constexpr const char* kEllipsoidNormal = R"glsl(
  vec3 normalVCVSOutput = side * normalize(s * inverseAxes);
  vec3 coatNormalVCVSOutput = normalVCVSOutput;
)glsl";

}  // namespace anamorph_vtk
