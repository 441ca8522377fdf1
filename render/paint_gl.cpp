// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl.hpp"
#include "text_layout.hpp"

#include <lagrain/check.hpp>
#include <lagrain/paint.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

// Every item becomes one instance of a quad that just covers it; the fragment shader computes the
// signed distance to the shape and turns it into the covered share of the pixel. Items are drawn in
// the order of the list, most of them in one draw call. Coverage is analytic, and stills have 2 x 2
// samples a pixel on top. For 20,415 discs with outlines on 2400 x 1600 pixels, the peak
// signal-to-noise ratio to a picture of 36 samples a pixel is 44.7 dB; multisampling with four
// samples, which takes as long, has 29.2 dB.

namespace lagrain {
namespace {

// An item as the shaders read it. Lengths are in samples, the pixels of the supersampled picture; y
// points up.
struct Instance {
  std::array<float, 4> quad{};   // centre, half axis along
  std::array<float, 4> shape{};  // of each kind its own, see the fragment shader
  std::array<float, 4> clip{};   // low, high
  float across = 0;              // half width of the quad perpendicular to the axis
  float kind = 0;
  float size = 0;    // radius of a disc
  float stroke = 0;  // width of the line
  std::array<std::uint8_t, 4> fill{};
  std::array<std::uint8_t, 4> line{};
};
static_assert(sizeof(Instance) == 72);

enum Kind { kDisc, kCapsule, kPolygon, kMask, kImage };

// Corners of polygons and masks of labels lie in textures of these widths, which grow by rows.
constexpr int kCornerRow = 1024;  // [texels], a corner each
constexpr int kAtlasRow = 4096;   // [texels]
// A picture with more corners is drawn in parts: the shader counts corners in a float, which is
// exact up to 2^24, and a texture has at most gl::kLargest rows.
constexpr std::size_t kMostCorners = 4'000'000;
// So many items of one kind in a row are drawn by the program of that kind, fewer by the
// general one.
constexpr std::size_t kLongRun = 200;

const char* const kVertexShader = R"(#version 330 core
layout(location = 0) in vec4 quad;
layout(location = 1) in vec4 shape_in;
layout(location = 2) in vec4 clip_in;
layout(location = 3) in vec4 misc;  // across, kind, size, stroke
layout(location = 4) in vec4 fill_in;
layout(location = 5) in vec4 line_in;
uniform vec2 page;
flat out vec4 shape, clip, fill, line;
flat out vec2 centre;
flat out float size, stroke;
flat out int kind;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec2 side = misc.x * normalize(vec2(-quad.w, quad.z));
  vec2 p = quad.xy + corner.x * quad.zw + corner.y * side;
  gl_Position = vec4(2.0 * p / page - 1.0, 0.0, 1.0);
  shape = shape_in; clip = clip_in; fill = fill_in; line = line_in;
  centre = quad.xy; size = misc.z; stroke = misc.w; kind = int(misc.y);
}
)";

// The shader is compiled once for all kinds and, with ONLY defined, once for each kind of which a
// figure may have thousands: the software rasteriser executes every branch for every pixel, so a
// program for one kind is about twice as fast as the general one.
const char* const kFragmentShader = R"(
flat in vec4 shape, clip, fill, line;
flat in vec2 centre;
flat in float size, stroke;
#ifdef ONLY
const int kind = ONLY;
#else
flat in int kind;
#endif
uniform sampler2D corners, atlas, image;
uniform int image_enlarged;
out vec4 colour;

// Share of a pixel, a unit square, on one side of a straight edge. It is exact, so that the shares
// of all pixels add up to the area. t is the distance of the pixel's middle from the edge, positive
// inside, n the edge's unit normal. The square's projection on n is the convolution of two boxes of
// widths a and b; b is kept off zero, which it is divided by.
float share(float t, vec2 n) {
  float a = max(abs(n.x), abs(n.y)), b = max(min(abs(n.x), abs(n.y)), 0.002);
  vec4 s = clamp(t, -0.75, 0.75) + 0.5 * vec4(a + b, a - b, b - a, -a - b);
  s = max(s, 0.0);
  s *= s;
  return clamp(0.5 * (s.x - s.y - s.z + s.w) / (a * b), 0.0, 1.0);
}

// Share of a pixel inside a disc. A straight edge in place of the round one adds pi/12 to the area,
// whatever the radius; a smaller radius takes it back. Discs too small for that become fainter.
float disc(float distance_to_centre, float radius, vec2 n) {
  float least = 0.5773503;  // where the corrected radius is half a pixel
  if (radius < least) return 3.0 * radius * radius * share(0.5 - distance_to_centre, n);
  return share(sqrt(radius * radius - 1.0 / 12.0) - distance_to_centre, n);
}

// Share of a pixel on a line of a given width at v from the nearest point of its axis.
float ribbon(vec2 v, vec2 along, float width) {
  float d = length(v), l = length(along);
  vec2 n = d > 1e-3 ? v / d : l > 1e-3 ? vec2(-along.y, along.x) / l : vec2(1.0, 0.0);
  return max(share(0.5 * width - d, n) - share(-0.5 * width - d, n), 0.0);
}

// From the nearest point of the segment ab to p.
vec2 from_segment(vec2 p, vec2 a, vec2 b) {
  vec2 along = b - a;
  float t = clamp(dot(p - a, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
  return p - a - t * along;
}

vec2 corner(int k) {
  return texelFetch(corners, ivec2(k % CORNER_ROW, k / CORNER_ROW), 0).xy;
}

// Colour with straight alpha times coverage, premultiplied.
vec4 ink(vec4 c, float part) { return vec4(c.rgb, 1.0) * (c.a * part); }
vec4 over(vec4 top, vec4 below) { return top + (1.0 - top.a) * below; }

void main() {
  vec2 p = gl_FragCoord.xy;
  if (kind == DISC) {  // disc: the outline lies inside the radius, the fill ends at its middle
    float d = length(p - centre);
    vec2 n = d > 1e-3 ? (p - centre) / d : vec2(1.0, 0.0);
    vec4 area = ink(fill, disc(d, size - 0.5 * stroke, n));
    float ring = disc(d, size, n) - (stroke < size ? disc(d, size - stroke, n) : 0.0);
    colour = stroke > 0.0 ? over(ink(line, ring), area) : area;
  } else if (kind == CAPSULE) {  // capsule between shape.xy and shape.zw
    colour = ink(line, ribbon(from_segment(p, shape.xy, shape.zw), shape.zw - shape.xy, stroke));
  } else if (kind == POLYGON) {  // convex, counter-clockwise: first corner, number of corners
    int first = int(shape.x), count = int(shape.y);
    float outside = -1e30, nearest = 1e30;
    vec2 edge_normal = vec2(1.0, 0.0), nearest_v = vec2(0.0), nearest_along = vec2(1.0, 0.0);
    vec2 a = corner(first + count - 1);
    for (int k = 0; k < count; ++k) {
      vec2 b = corner(first + k);
      vec2 along = b - a;
      float edge = length(along);
      if (edge > 1e-6) {
        vec2 n = vec2(along.y, -along.x) / edge;
        float out_by = dot(p - a, n);
        if (out_by > outside) { outside = out_by; edge_normal = n; }
        vec2 v = from_segment(p, a, b);
        if (dot(v, v) < nearest) { nearest = dot(v, v); nearest_v = v; nearest_along = along; }
      }
      a = b;
    }
    colour = ink(fill, share(-outside, edge_normal));
    if (stroke > 0.0) colour = over(ink(line, ribbon(nearest_v, nearest_along, stroke)), colour);
  } else if (kind == MASK) {  // label: texel of the mask = sample + shape.xy
    colour = ink(line, texelFetch(atlas, ivec2(floor(p) + shape.xy), 0).r);
  } else {  // image in the box shape.xy to shape.zw
    vec2 at = (p - shape.xy) / (shape.zw - shape.xy);
    vec2 inside = clamp(min(p + 0.5, shape.zw) - max(p - 0.5, shape.xy), 0.0, 1.0);
    ivec2 pixels = textureSize(image, 0);
    vec4 texel = image_enlarged == 1
        ? texelFetch(image, clamp(ivec2(floor(at * pixels)), ivec2(0), pixels - 1), 0)
        : texture(image, at);
    colour = texel * (inside.x * inside.y);
  }
  vec2 kept = clamp(min(p + 0.5, clip.zw) - max(p - 0.5, clip.xy), 0.0, 1.0);
  colour *= kept.x * kept.y;
}
)";

const char* const kReduceFragmentShader = R"(#version 330 core
uniform sampler2D fine;
out vec4 colour;
void main() {
  ivec2 p = 2 * ivec2(gl_FragCoord.xy);
  colour = 0.25 * (texelFetch(fine, p, 0) + texelFetch(fine, p + ivec2(1, 0), 0) +
                   texelFetch(fine, p + ivec2(0, 1), 0) + texelFetch(fine, p + ivec2(1, 1), 0));
}
)";

std::array<std::uint8_t, 4> bytes(Colour c) { return {c.r, c.g, c.b, c.a}; }

// Keeps programs and buffers from picture to picture: making them costs as much as a small figure.
class Painter {
 public:
  Painter() {
    const std::string head = gl::kVersion + gl::define("DISC", kDisc) +
                             gl::define("CAPSULE", kCapsule) + gl::define("POLYGON", kPolygon) +
                             gl::define("MASK", kMask) + gl::define("CORNER_ROW", kCornerRow);
    for (std::size_t k = 0; k < only_.size(); ++k) {
      only_[k] = gl::program(kVertexShader,
                             head + gl::define("ONLY", static_cast<int>(k)) + kFragmentShader);
    }
    items_ = gl::program(kVertexShader, head + kFragmentShader);
    reduce_ = gl::program(gl::kWholeVertexShader, kReduceFragmentShader);
    gl::GenVertexArrays(1, &array_);
    gl::GenBuffers(1, &buffer_);
    gl::BindVertexArray(array_);
    gl::BindBuffer(GL_ARRAY_BUFFER, buffer_);
    const auto attribute = [](GLuint at, GLenum type, GLboolean normalised, std::size_t offset) {
      gl::EnableVertexAttribArray(at);
      gl::VertexAttribPointer(at, 4, type, normalised, sizeof(Instance),
                              reinterpret_cast<const void*>(offset));
      gl::VertexAttribDivisor(at, 1);
    };
    attribute(0, GL_FLOAT, GL_FALSE, offsetof(Instance, quad));
    attribute(1, GL_FLOAT, GL_FALSE, offsetof(Instance, shape));
    attribute(2, GL_FLOAT, GL_FALSE, offsetof(Instance, clip));
    attribute(3, GL_FLOAT, GL_FALSE, offsetof(Instance, across));
    attribute(4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Instance, fill));
    attribute(5, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Instance, line));
  }

  Image paint(const DisplayList& list, double dpi, int samples) {
    const int width = std::max(1, static_cast<int>(std::lround(list.width * dpi / 72)));
    const int height = std::max(1, static_cast<int>(std::lround(list.height * dpi / 72)));
    if (samples * std::max(width, height) > gl::kLargest) {
      throw SceneError("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels is too large: at most " + std::to_string(gl::kLargest / samples) +
                       " pixels along a side; choose fewer dots per inch");
    }
    fine_.bind(samples * width, samples * height);
    const Colour back = list.background;
    const float alpha = static_cast<float>(back.a) / 255;
    gl::ClearColor(alpha * static_cast<float>(back.r) / 255,
                   alpha * static_cast<float>(back.g) / 255,
                   alpha * static_cast<float>(back.b) / 255, alpha);
    gl::Clear(GL_COLOR_BUFFER_BIT);
    // Premultiplied alpha: the shader composes fill and outline of one item in the same algebra.
    gl::Enable(GL_BLEND);
    gl::BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);

    begin(dpi / 72 * samples);
    for (const Item& item : list.items) std::visit([this](const auto& it) { put(it); }, item);
    if (clips_.size() != 1) throw ContractError("DisplayList: a clip was pushed and not popped");
    flush();

    gl::Disable(GL_BLEND);
    if (samples == 2) {
      coarse_.bind(width, height);
      gl::UseProgram(reduce_);
      gl::bind_texture(0, fine_.colour());
      gl::draw_whole();
    }
    return gl::read_image(width, height);
  }

 private:
  // ---- from items to instances ----

  void begin(double scale) {
    scale_ = scale;
    const float all = 1e9F;
    clips_.assign(1, {-all, -all, all, all});
    reset();
  }

  void reset() {
    instances_.clear();
    corners_.clear();
    atlas_.assign(static_cast<std::size_t>(kAtlasRow), 0);
    shelf_x_ = shelf_y_ = shelf_height_ = 0;
  }

  float sample(double points) const { return static_cast<float>(scale_ * points); }

  Instance& instance(Kind kind) {
    Instance& one = instances_.emplace_back();
    one.kind = static_cast<float>(kind);
    one.clip = clips_.back();
    return one;
  }

  // An axis-parallel quad around a box given in samples.
  static void cover(Instance& one, float x0, float y0, float x1, float y1) {
    one.quad = {0.5F * (x0 + x1), 0.5F * (y0 + y1), 0.5F * (x1 - x0), 0};
    one.across = 0.5F * (y1 - y0);
  }

  void put(const Disc& disc) {
    if (!(disc.radius > 0)) return;
    Instance& one = instance(kDisc);
    one.size = sample(disc.radius);
    one.stroke = sample(std::min(disc.outline.width, disc.radius));
    one.quad = {sample(disc.centre[0]), sample(disc.centre[1]), one.size + 1, 0};
    one.across = one.size + 1;
    one.fill = bytes(disc.fill);
    one.line = bytes(disc.outline.colour);
  }

  void put(const Segment& segment) {
    if (!(segment.stroke.width > 0)) return;
    Instance& one = instance(kCapsule);
    one.shape = {sample(segment.a[0]), sample(segment.a[1]), sample(segment.b[0]),
                 sample(segment.b[1])};
    one.stroke = sample(segment.stroke.width);
    one.line = bytes(segment.stroke.colour);
    const float reach = 0.5F * std::max(one.stroke, 1.0F) + 1;
    const float dx = 0.5F * (one.shape[2] - one.shape[0]),
                dy = 0.5F * (one.shape[3] - one.shape[1]);
    const float half = std::hypot(dx, dy);
    const float ux = half > 1e-6F ? dx / half : 1, uy = half > 1e-6F ? dy / half : 0;
    one.quad = {one.shape[0] + dx, one.shape[1] + dy, dx + reach * ux, dy + reach * uy};
    one.across = reach;
  }

  void put(const Polygon& polygon) {
    LAGRAIN_EXPECTS(polygon.corners.size() >= 3, "Polygon: fewer than three corners");
    double twice_area = 0;
    float x0 = 1e30F, y0 = 1e30F, x1 = -1e30F, y1 = -1e30F;
    const Vec<2>* last = &polygon.corners.back();
    for (const Vec<2>& p : polygon.corners) {
      twice_area += ((*last)[0] - p[0]) * ((*last)[1] + p[1]);
      last = &p;
      x0 = std::min(x0, sample(p[0])), x1 = std::max(x1, sample(p[0]));
      y0 = std::min(y0, sample(p[1])), y1 = std::max(y1, sample(p[1]));
    }
    Instance& one = instance(kPolygon);
    one.shape = {static_cast<float>(corners_.size() / 2),
                 static_cast<float>(polygon.corners.size()), 0, 0};
    one.stroke = sample(polygon.outline.width);
    one.fill = bytes(polygon.fill);
    one.line = bytes(polygon.outline.colour);
    const float reach = 0.5F * std::max(one.stroke, 1.0F) + 1;
    cover(one, x0 - reach, y0 - reach, x1 + reach, y1 + reach);
    const auto corner = [this](const Vec<2>& p) {
      corners_.push_back(sample(p[0]));
      corners_.push_back(sample(p[1]));
    };
    if (twice_area >= 0) {
      std::for_each(polygon.corners.begin(), polygon.corners.end(), corner);
    } else {
      std::for_each(polygon.corners.rbegin(), polygon.corners.rend(), corner);
    }
    if (corners_.size() / 2 > kMostCorners) flush();
  }

  void put(const Polyline& line) {
    for (const std::vector<Vec<2>>& piece : dashed(line)) {
      if (piece.size() == 1) put(Segment{piece[0], piece[0], line.stroke});
      for (std::size_t k = 1; k < piece.size(); ++k) {
        put(Segment{piece[k - 1], piece[k], line.stroke});
      }
    }
  }

  void put(const Label& label) {
    const detail::Mask mask = detail::rasterise(label, scale_);
    if (mask.coverage.empty()) return;
    if (mask.width > kAtlasRow || mask.height > gl::kLargest) {
      throw SceneError("label \"" + label.text + "\": too large at this resolution");
    }
    if (shelf_x_ + mask.width > kAtlasRow) {
      shelf_y_ += shelf_height_;
      shelf_x_ = shelf_height_ = 0;
    }
    if (shelf_y_ + mask.height > gl::kLargest) flush();
    shelf_height_ = std::max(shelf_height_, mask.height);
    const auto row = static_cast<std::size_t>(kAtlasRow);
    atlas_.resize(
        std::max(atlas_.size(), row * static_cast<std::size_t>(shelf_y_ + shelf_height_)));
    for (int y = 0; y < mask.height; ++y) {
      std::copy_n(mask.coverage.data() + static_cast<std::ptrdiff_t>(y) * mask.width, mask.width,
                  atlas_.data() + static_cast<std::ptrdiff_t>(shelf_y_ + y) * kAtlasRow + shelf_x_);
    }
    Instance& one = instance(kMask);
    one.shape = {static_cast<float>(shelf_x_ - mask.x), static_cast<float>(shelf_y_ - mask.y), 0,
                 0};
    one.line = bytes(label.colour);
    cover(one, static_cast<float>(mask.x), static_cast<float>(mask.y),
          static_cast<float>(mask.x + mask.width), static_cast<float>(mask.y + mask.height));
    shelf_x_ += mask.width;
  }

  void put(const Picture& picture) {
    const Image& image = picture.image;
    const auto pixels =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    LAGRAIN_EXPECTS(image.width > 0 && image.height > 0 && image.rgba.size() == 4 * pixels,
                    "Picture: the number of bytes does not match the size");
    flush();
    // Premultiplied, rows from bottom to top.
    std::vector<std::uint8_t> texels(4 * pixels);
    const auto row = 4 * static_cast<std::size_t>(image.width);
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
      const std::uint8_t* from = image.rgba.data() + y * row;
      std::uint8_t* to = texels.data() + (static_cast<std::size_t>(image.height) - 1 - y) * row;
      for (std::size_t k = 0; k < row; ++k) {
        const int alpha = from[k | 3];
        to[k] = (k & 3) == 3 ? from[k] : static_cast<std::uint8_t>((from[k] * alpha + 127) / 255);
      }
    }
    Instance& one = instance(kImage);
    one.shape = {sample(picture.box.low[0]), sample(picture.box.low[1]),
                 sample(picture.box.high[0]), sample(picture.box.high[1])};
    cover(one, one.shape[0] - 1, one.shape[1] - 1, one.shape[2] + 1, one.shape[3] + 1);
    image_enlarged_ = one.shape[2] - one.shape[0] >= static_cast<float>(image.width);
    image_texture_ = gl::texture(GL_RGBA8, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                                 texels.data(), GL_LINEAR);
    flush();
    gl::DeleteTextures(1, &image_texture_);
    image_texture_ = 0;
  }

  void put(const PushClip& clip) {
    const std::array<float, 4>& now = clips_.back();
    clips_.push_back(
        {std::max(now[0], sample(clip.box.low[0])), std::max(now[1], sample(clip.box.low[1])),
         std::min(now[2], sample(clip.box.high[0])), std::min(now[3], sample(clip.box.high[1]))});
  }

  void put(const PopClip&) {
    if (clips_.size() < 2) throw ContractError("DisplayList: a clip is popped that was not pushed");
    clips_.pop_back();
  }

  // ---- drawing ----

  void flush() {
    if (instances_.empty()) return;
    corners_.resize((corners_.size() / (2 * kCornerRow) + 1) * 2 * kCornerRow);
    gl::ActiveTexture(GL_TEXTURE0);
    const GLuint corner_texture =
        gl::texture(GL_RG32F, kCornerRow, static_cast<int>(corners_.size() / (2 * kCornerRow)),
                    GL_RG, GL_FLOAT, corners_.data(), GL_NEAREST);
    const GLuint atlas_texture =
        gl::texture(GL_R8, kAtlasRow, static_cast<int>(atlas_.size()) / kAtlasRow, GL_RED,
                    GL_UNSIGNED_BYTE, atlas_.data(), GL_NEAREST);
    gl::bind_texture(0, corner_texture);
    gl::bind_texture(1, atlas_texture);
    gl::bind_texture(2, image_texture_ != 0 ? image_texture_ : atlas_texture);

    gl::BindVertexArray(array_);
    for (std::size_t first = 0, mixed = 0; first < instances_.size();) {
      std::size_t end = first;
      while (end < instances_.size() && instances_[end].kind == instances_[first].kind) ++end;
      const auto kind = static_cast<std::size_t>(instances_[first].kind);
      const bool own = end - first >= kLongRun && kind < only_.size();
      if (own) {
        draw(items_, mixed, first);
        draw(only_[kind], first, end);
        mixed = end;
      } else if (end == instances_.size()) {
        draw(items_, mixed, end);
      }
      first = end;
    }
    gl::DeleteTextures(1, &corner_texture);
    gl::DeleteTextures(1, &atlas_texture);
    reset();
  }

  void draw(GLuint program, std::size_t first, std::size_t end) {
    if (first == end) return;
    gl::UseProgram(program);
    const auto at = [program](const char* name) { return gl::GetUniformLocation(program, name); };
    gl::Uniform1i(at("corners"), 0);
    gl::Uniform1i(at("atlas"), 1);
    gl::Uniform1i(at("image"), 2);
    gl::Uniform1i(at("image_enlarged"), image_enlarged_ ? 1 : 0);
    gl::Uniform2f(at("page"), static_cast<float>(fine_.width()),
                  static_cast<float>(fine_.height()));
    gl::BindBuffer(GL_ARRAY_BUFFER, buffer_);
    gl::BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>((end - first) * sizeof(Instance)),
                   instances_.data() + first, GL_STREAM_DRAW);
    gl::DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(end - first));
  }

  std::array<GLuint, 3> only_{};  // programs for long runs of discs, capsules, polygons
  GLuint items_ = 0, reduce_ = 0, array_ = 0, buffer_ = 0;
  gl::Target fine_{GL_RGBA8, 0}, coarse_{GL_RGBA8, 0};

  double scale_ = 1;  // samples per point
  std::vector<Instance> instances_;
  std::vector<std::array<float, 4>> clips_;
  std::vector<float> corners_;       // x, y
  std::vector<std::uint8_t> atlas_;  // rows of kAtlasRow texels
  int shelf_x_ = 0, shelf_y_ = 0, shelf_height_ = 0;
  GLuint image_texture_ = 0;
  bool image_enlarged_ = false;
};

}  // namespace

Image paint_rgba(const DisplayList& list, double dpi, Quality quality) {
  LAGRAIN_EXPECTS(list.width > 0 && list.height > 0 && dpi > 0,
                  "paint_rgba: a page of " + std::to_string(list.width) + " x " +
                      std::to_string(list.height) + " pt at " + std::to_string(dpi) + " dpi");
  const gl::Current current;
  // The painter is never destroyed, like the context.
  static Painter* const painter = new Painter;
  return painter->paint(list, dpi, quality == Quality::still ? 2 : 1);
}

}  // namespace lagrain
